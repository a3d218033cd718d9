// Runs the pelage command in a folder of its own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace pelage {

namespace fs = std::filesystem;

inline std::string slurp(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

struct Outcome {
  int status;  // exit status, or 128 + signal
  std::string out, err;
};

inline int status_of(int wait_status) {
  return WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 128 + WTERMSIG(wait_status);
}

class Cli : public testing::Test {
 protected:
  Cli() {
    folder_ = fs::path(testing::TempDir()) /
              ("cli_" + std::to_string(getpid()) + "_" + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  ~Cli() override { fs::remove_all(folder_); }

  fs::path in(const std::string& name) const { return folder_ / name; }

  Outcome run(const std::string& arguments) const {
    const std::string command =
        "cd '" + folder_.string() + "' && '" PELAGE_COMMAND "' " + arguments + " >.out 2>.err </dev/null";
    const int status = std::system(command.c_str());
    return {status_of(status), slurp(in(".out")), slurp(in(".err"))};
  }
  void make_hair() const {
    const Outcome made = run("grow curly --strands 300 --points 16 -o hair.pelage");
    ASSERT_EQ(made.status, 0) << made.err;
  }
  // What lies in the folder but the streams' own files and `hair.pelage`.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (name != ".out" && name != ".err" && name != "hair.pelage") names.push_back(name);
    }
    return names;
  }

  fs::path folder_;
};

}  // namespace pelage
