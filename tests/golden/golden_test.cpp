// Golden images: every scene file of this folder is rendered and compared with the hash and the picture beside it.
// README.md says how to add one and how to bless a change.
#include <gtest/gtest.h>
#include <pelage/pelage.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace pelage {
namespace {

namespace fs = std::filesystem;

// Mean absolute difference of display values, 0…1, that another backend may show.
constexpr double kPerceptualBound = 0.002;

/// Those of hair meshes begin with swr; a build may leave them out.
std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(PELAGE_SOURCE_DIR) / "tests/golden")) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() == ".json" && !(name.starts_with("swr") && hair_mesh_style_names().empty()))
      names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// What a display shows, as `write_image` stores it.
std::vector<std::uint8_t> bytes_of(const Image& display) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(display.pixels.size());
  for (const float value : display.pixels) bytes.push_back(static_cast<std::uint8_t>(std::clamp(value, 0.f, 1.f) * 255 + 0.5f));
  return bytes;
}

/// FNV-1a, 64 bits, as text.
std::string hash_of(const std::vector<std::uint8_t>& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

std::string first_word(const fs::path& file) {
  std::string word;
  std::ifstream(file) >> word;
  return word;
}

/// |a − b| eight times brightened, so that one sees where it is.
Image difference_of(const Image& a, const Image& b) {
  Image difference(a.width, a.height, {"R", "G", "B"});
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      for (int c = 0; c < 3; ++c) difference.at(x, y)[c] = std::min(1.f, 8 * std::fabs(a.at(x, y)[c] - b.at(x, y)[c]));
  return difference;
}

double mean_difference(const Image& a, const Image& b) {
  double sum = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      for (int c = 0; c < 3; ++c) sum += std::fabs(a.at(x, y)[c] - b.at(x, y)[c]);
  return sum / (3.0 * a.width * a.height);
}

class Golden : public testing::TestWithParam<std::string> {
 protected:
  fs::path beside(const std::string& extension) const {
    return fs::path(PELAGE_SOURCE_DIR) / "tests/golden" / (GetParam() + extension);
  }
  void TearDown() override {
    set_isa("");
    set_thread_count(0);
  }
  Scene scene_ = read_scene(beside(".json").string());
};

TEST_P(Golden, LooksAsBlessed) {
  const Image display = render(scene_).display;
  const std::string hash = hash_of(bytes_of(display));
  if (const char* update = std::getenv("PELAGE_UPDATE_GOLDEN"); update && (!*update || GetParam() == update)) {
    std::ofstream(beside(".hash")) << hash << "\n";
    write_image(beside(".png").string(), display);
    GTEST_SKIP() << "blessed as " << hash << "; look at " << beside(".png");
  }
  ASSERT_TRUE(fs::exists(beside(".png"))) << "no picture yet; run tools/update_golden.sh " << GetParam();
  const Image reference = read_image(beside(".png").string(), false);
  ASSERT_EQ(reference.width, display.width);
  ASSERT_EQ(reference.height, display.height);
  const double difference = mean_difference(display, reference);
  if (hash != first_word(beside(".hash")) || difference > kPerceptualBound) {
    const fs::path folder = fs::absolute("golden_failures");
    fs::create_directories(folder);
    write_image((folder / (GetParam() + ".image.png")).string(), display);
    write_image((folder / (GetParam() + ".reference.png")).string(), reference);
    write_image((folder / (GetParam() + ".difference.png")).string(), difference_of(display, reference));
    ADD_FAILURE() << "image, reference and difference (8x) are in " << folder;
  }
  EXPECT_LE(difference, kPerceptualBound);
  EXPECT_EQ(hash, first_word(beside(".hash")))
      << "mean difference " << difference << "; if it is meant, tools/update_golden.sh " << GetParam();
}

TEST_P(Golden, EveryInstructionSetAndThreadCountGivesTheSameBits) {
  const Image first = render(scene_).linear;
  for (const std::string& isa : available_isas()) {
    set_isa(isa);
    EXPECT_EQ(render(scene_).linear.pixels, first.pixels) << isa;
  }
  set_isa("");
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    EXPECT_EQ(render(scene_).linear.pixels, first.pixels) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Scene, Golden, testing::ValuesIn(scene_names()), [](const auto& test) { return test.param; });

}  // namespace
}  // namespace pelage
