// pelage bench: checks and times named cases.
#include "bench/bench.h"

#include <fmt/format.h>
#include <pelage/error.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "verbs.h"

namespace pelage::cli {
namespace {

struct BenchOptions {
  std::string pattern, json_path;
  bool list = false;
};

void list_cases(const bench::Suite& suite) {
  for (const bench::Case& c : suite.cases) fmt::print("{:<44} {}\n", c.name, c.metric);
  for (const bench::Ratio& r : suite.ratios) fmt::print("{:<44} ratio: {} / {}\n", r.name, r.over.name, r.under.name);
}

void print_row(const bench::Result& r) {
  if (!r.skipped.empty()) fmt::print("{:<44} skipped: {}\n", r.name, r.skipped);
  else if (!r.failed.empty()) fmt::print("{:<44} WRONG: {}\n", r.name, r.failed);
  else fmt::print("{:<44} {:>11.4g} ±{:<9.2g} {:<4} {} ({} runs)\n", r.name, r.value, r.mad, r.unit, r.metric, r.runs);
  std::fflush(stdout);
}

// Where the lines of JSON go: nowhere, standard output ("-") or a file.
class JsonLines {
 public:
  explicit JsonLines(const std::string& path) : path_(path) {
    if (path.empty()) return;
    file_ = path == "-" ? stdout : std::fopen(path.c_str(), "w");
    if (!file_) throw Error(path, "", "cannot be written", "");
  }
  ~JsonLines() {
    if (file_ && file_ != stdout) std::fclose(file_);
  }
  JsonLines(const JsonLines&) = delete;
  JsonLines& operator=(const JsonLines&) = delete;

  void write(const bench::Result& result) {
    if (!file_) return;
    const std::string line = bench::to_json(result) + "\n";
    if (std::fputs(line.c_str(), file_) < 0 || std::fflush(file_) != 0) throw Error(path_, "", "cannot be written", "");
  }

 private:
  std::string path_;
  std::FILE* file_ = nullptr;
};

void bench_verb(const BenchOptions& options) {
  const bench::Suite suite = bench::all_cases();
  if (options.list) return list_cases(suite);
  JsonLines json(options.json_path);
  std::string wrong;
  bench::run(suite, options.pattern, [&](const bench::Result& result) {
    if (options.json_path != "-") print_row(result);
    json.write(result);
    if (!result.failed.empty()) wrong += (wrong.empty() ? "" : ", ") + result.name;
  });
  if (!wrong.empty()) throw Error("bench", wrong, "the answer is wrong", "nothing was timed there");
}

}  // namespace

void add_bench(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("bench", "Check and time named cases");
  auto options = std::make_shared<BenchOptions>();
  verb->add_option("REGEX", options->pattern, "Part of the names of the cases to run; all without it");
  verb->add_option("--json", options->json_path, "Write one JSON object a line to FILE; - for standard output")
      ->type_name("FILE");
  verb->add_flag("--list", options->list, "Name the cases and what they measure");
  add_machine_options(*verb);
  verb->footer(
      "Each case first compares its answer with a slow reference; a wrong answer fails the run.\n"
      "Examples:\n"
      "  pelage bench --list\n"
      "  pelage bench 'raster.*curly50k' --threads 2 --json raster.json");
  verb->callback([options] { bench_verb(*options); });
}

}  // namespace pelage::cli
