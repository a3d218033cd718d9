// The report without a browser: what its input may say, what is computed, what is written, what is left when it fails.
#include "report/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/io.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "report/pack.h"
#include "report/summary.h"
#include "report/thumbnail.h"

namespace pelage::report {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

std::string slurp(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

template <class Work>
std::string message_of(Work work) {
  try {
    work();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

class Report : public testing::Test {
 protected:
  Report() {
    folder_ = fs::path(testing::TempDir()) /
              ("report_" + std::to_string(getpid()) + "_" + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  ~Report() override { fs::remove_all(folder_); }

  std::string in(const std::string& name) const { return (folder_ / name).string(); }

  // A gray gradient with hair, and coverage, in its right half; `error` is added to the hair.
  void write_picture(const std::string& name, float error, int width = 32) const {
    Image image(width, 24, {"R", "G", "B", "coverage"});
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < width; ++x) {
        const bool hair = x >= width / 2;
        float* const p = image.at(x, y);
        p[0] = p[1] = p[2] = 0.01f * static_cast<float>(y) + (hair ? error : 0);
        p[3] = hair;
      }
    write_image(in(name), image, true);
  }
  static Json valid() {
    return Json::parse(R"({
      "title": "Test", "reference": "truth", "axes": ["style", "distance"],
      "methods": [{"name": "good", "label": "Good"}, {"name": "bad"}, {"name": "truth"}],
      "cases": [
        {"title": "First", "axes": {"style": "curly", "distance": 1}, "images": [
          {"method": "good", "file": "good.exr", "time": 2, "samples": 8}, {"method": "bad", "file": "bad.exr", "time": 1},
          {"method": "truth", "file": "truth.exr"}]},
        {"title": "Second", "axes": {"style": "wavy", "distance": 2.5}, "images": [
          {"method": "good", "file": "bad.exr", "time": 4}, {"method": "truth", "file": "truth.exr"}]}]})");
  }
  void write_pictures() const {
    write_picture("truth.exr", 0);
    write_picture("good.exr", 0.02f);
    write_picture("bad.exr", 0.2f);
  }
  Cases read(const Json& json) const {
    std::ofstream(in("cases.json")) << json.dump(1);
    return read_cases(in("cases.json"));
  }
  std::string error_of(const Json& json) const {
    return message_of([&] { read(json); });
  }
  static std::vector<CaseNumbers> measure_all(const Cases& cases) {
    std::vector<CaseNumbers> numbers;
    for (const Case& c : cases.cases) numbers.push_back(measure(cases, c).numbers);
    return numbers;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> list;
    for (const auto& entry : fs::directory_iterator(folder_)) list.push_back(entry.path().filename().string());
    std::sort(list.begin(), list.end());
    return list;
  }

  fs::path folder_;
};

// ---- Input --------------------------------------------------------------------------------------------------------------

TEST_F(Report, ReadsWhatTheFileSays) {
  const Cases cases = read(valid());
  EXPECT_EQ(cases.title, "Test");
  ASSERT_EQ(cases.methods.size(), 3u);
  EXPECT_EQ(cases.methods[0].label, "Good");
  EXPECT_EQ(cases.methods[1].label, "bad") << "a method without label is called by its name";
  ASSERT_EQ(cases.cases.size(), 2u);
  EXPECT_EQ(cases.cases[0].reference, "truth");
  EXPECT_EQ(cases.cases[0].images[0].seconds, 2);
  EXPECT_EQ(cases.cases[0].images[0].samples, 8);
  const auto& axes = cases.cases[1].axes;
  EXPECT_TRUE(
      std::any_of(axes.begin(), axes.end(), [](const AxisValue& v) { return v.axis == "distance" && v.number == 2.5; }));
}

TEST_F(Report, FindsMethodsAndAxesWithoutLists) {
  Json json = valid();
  json.erase("methods");
  json.erase("axes");
  const Cases cases = read(json);
  ASSERT_EQ(cases.methods.size(), 3u);
  EXPECT_EQ(cases.methods[2].name, "truth");
  EXPECT_THAT(cases.axes, ElementsAre("distance", "style"));
}

TEST_F(Report, TellsWhatIsWrongWithTheFile) {
  Json json = valid();
  json["cases"][0]["imags"] = 1;
  EXPECT_THAT(error_of(json), AllOf(HasSubstr("unknown key `imags`"), HasSubstr("did you mean `images`?"), HasSubstr("line ")));
  json = valid();
  json["cases"][1]["images"][0]["method"] = "goud";
  EXPECT_THAT(error_of(json), AllOf(HasSubstr("case \"Second\""), HasSubstr("`goud`"), HasSubstr("did you mean `good`?")));
  json = valid();
  json["cases"][1]["reference"] = "bad";
  EXPECT_THAT(error_of(json), AllOf(HasSubstr("case \"Second\""), HasSubstr("no image of this case has the name `bad`")));
  json = valid();
  json["cases"][0]["images"][1]["method"] = "good";
  EXPECT_THAT(error_of(json), AllOf(HasSubstr("case \"First\""), HasSubstr("`good` has two images")));
  json = valid();
  json["cases"][0]["axes"]["stile"] = "x";
  EXPECT_THAT(error_of(json), HasSubstr("did you mean `style`?"));
  json = valid();
  json.erase("reference");
  EXPECT_THAT(error_of(json), AllOf(HasSubstr("case \"First\""), HasSubstr("no reference")));
  json = valid();
  json["cases"] = Json::array();
  EXPECT_THAT(error_of(json), HasSubstr("no case"));
  json = valid();
  json["cases"][1]["images"].erase(0);
  EXPECT_THAT(error_of(json), HasSubstr("1 images"));
  json = valid();
  json["cases"][0]["images"][0]["values"] = {{"flicker", 1}};
  EXPECT_THAT(error_of(json), HasSubstr("no metric of the list `values` has the name `flicker`"));
  std::ofstream(in("cases.json")) << "{";
  EXPECT_THAT(message_of([&] { read_cases(in("cases.json")); }), HasSubstr("docs/report.schema.json"));
}

TEST_F(Report, SchemaIsThePublishedOne) {
  EXPECT_EQ(slurp(PELAGE_SOURCE_DIR "/docs/report.schema.json"), cases_schema())
      << "make it again: pelage report --schema > docs/report.schema.json";
}

// ---- Numbers ------------------------------------------------------------------------------------------------------------

TEST_F(Report, TellsTheCaseOfAPictureThatCannotBeUsed) {
  write_pictures();
  const auto failure = [&](const Json& json) { return message_of([&] { measure_all(read(json)); }); };
  Json json = valid();
  json["cases"][1]["images"][0]["file"] = "missing.exr";
  EXPECT_THAT(failure(json), AllOf(HasSubstr("case \"Second\""), HasSubstr("good"), HasSubstr("missing.exr")));
  write_picture("small.exr", 0, 16);
  json["cases"][1]["images"][0]["file"] = "small.exr";
  EXPECT_THAT(failure(json), AllOf(HasSubstr("case \"Second\""), HasSubstr("good"), HasSubstr("16")));
  write_picture("nan.exr", std::nanf(""));
  json["cases"][1]["images"][0]["file"] = "nan.exr";
  EXPECT_THAT(failure(json), AllOf(HasSubstr("case \"Second\""), HasSubstr("good"), HasSubstr("16, 0")));
  json["cases"][1]["images"][0]["file"] = "good.exr";
  json["cases"][1]["mask"] = "small.exr";
  EXPECT_THAT(failure(json), AllOf(HasSubstr("case \"Second\""), HasSubstr("mask")));
}

TEST_F(Report, MeasuresHairAndWhole) {
  write_pictures();
  const Cases cases = read(valid());
  const std::vector<CaseNumbers> numbers = measure_all(cases);
  EXPECT_EQ(numbers[0].hair_pixels, 16u * 24);
  const std::vector<Column> table = columns(cases);
  EXPECT_EQ(table.front().key, "flip") << "the first column is the one of the error maps";
  const auto column = [&](const std::string& key) {
    return static_cast<std::size_t>(std::find_if(table.begin(), table.end(), [&](const Column& c) { return c.key == key; }) -
                                    table.begin());
  };
  const Measurement& bad = numbers[0].entries[1];
  EXPECT_NEAR(*bad.hair[column("mse")], 2 * *bad.whole[column("mse")], 1e-6) << "outside of the hair nothing differs";
  EXPECT_LT(*numbers[0].entries[0].hair[column("flip")], *bad.hair[column("flip")]);
  EXPECT_TRUE(numbers[0].entries[2].whole.empty()) << "the reference is not measured";
}

TEST_F(Report, EqualPicturesHaveInfinitePsnr) {
  write_pictures();
  Json json = valid();
  json["cases"][0]["images"][0]["file"] = "truth.exr";
  const Cases cases = read(json);
  const MeasuredCase measured = measure(cases, cases.cases[0]);
  const std::vector<Column> table = columns(cases);
  for (std::size_t j = 0; j < table.size(); ++j) {
    const std::optional<double> value = measured.numbers.entries[0].hair[j];
    EXPECT_EQ(table[j].key == "psnr", value && std::isinf(*value)) << table[j].key;
  }
}

TEST_F(Report, MaskComesBeforeCoverage) {
  write_pictures();
  Image mask(32, 24, {"R", "G", "B"});
  mask.at(3, 4)[0] = mask.at(20, 5)[0] = 1;
  write_image(in("mask.exr"), mask);
  Json json = valid();
  json["cases"][0]["mask"] = "mask.exr";
  EXPECT_EQ(measure_all(read(json))[0].hair_pixels, 2u);
}

TEST_F(Report, ShowsValuesFromElsewhere) {
  write_pictures();
  Json json = valid();
  json["values"] = {{{"name", "votes"}, {"better", "higher"}}};
  json["cases"][0]["images"][1]["values"] = {{"votes", 12}};
  const Cases cases = read(json);
  EXPECT_TRUE(columns(cases).back().higher_is_better);
  const std::vector<CaseNumbers> numbers = measure_all(cases);
  EXPECT_EQ(numbers[0].entries[1].hair.back(), 12);
  EXPECT_EQ(numbers[0].entries[0].hair.back(), std::nullopt);
  EXPECT_THAT(summary_markdown(cases, numbers), HasSubstr("votes ↑"));
}

// Two cases by hand: the summary alone.
TEST_F(Report, SummaryIsTheMeanAndMarksTheBest) {
  const Cases cases = read(valid());
  const std::size_t n = columns(cases).size();
  std::vector<CaseNumbers> numbers(2);
  const auto filled = [&](double x) { return Measurement{Numbers(n, 10 * x), Numbers(n, x)}; };
  numbers[0] = {1, 1, 1, {filled(0.1), filled(0.4), {}}};
  numbers[1] = {1, 1, 1, {filled(0.2), {}}};
  const std::vector<SummaryRow> rows = summarize(cases, numbers);
  ASSERT_EQ(rows.size(), 2u) << "the reference has no row";
  EXPECT_EQ(rows[0].cases, 2u);
  EXPECT_NEAR(*rows[0].hair[0], 0.15, 1e-12);
  EXPECT_NEAR(*rows[0].whole[0], 1.5, 1e-12);
  EXPECT_EQ(rows[0].seconds, 3);
  const std::string text = summary_markdown(cases, numbers);
  EXPECT_THAT(text,
              AllOf(HasSubstr("| Good | **0.1500** |"), HasSubstr("FLIP ↓"), HasSubstr("PSNR ↑"), HasSubstr("**0.4000**")));
  const std::string by = axis_markdown(cases, numbers, "style", "flip");
  EXPECT_THAT(by, AllOf(HasSubstr("| FLIP, style | curly | wavy |"), HasSubstr("| Good | **0.1000** | **0.2000** |"),
                        HasSubstr("| bad | 0.4000 | – |")));
  EXPECT_THAT(message_of([&] { axis_markdown(cases, numbers, "stile", "flip"); }), HasSubstr("did you mean `style`?"));
  EXPECT_THAT(message_of([&] { axis_markdown(cases, numbers, "style", "flop"); }), HasSubstr("did you mean `flip`?"));
}

TEST_F(Report, WhatLooksTheSameIsBestTogetherUnlessAllOfItIs) {
  Json json = valid();
  json["methods"].push_back({{"name", "third"}, {"label", "Third"}});
  json["cases"][0]["images"].push_back({{"method", "third"}, {"file", "third.exr"}});
  json["cases"].erase(1);
  const Cases cases = read(json);
  const std::size_t n = columns(cases).size();
  const auto summary = [&](double good, double bad, double third) {
    const auto filled = [&](double x) { return Measurement{Numbers(n, x), Numbers(n, x)}; };
    return summary_markdown(cases, {{1, 1, 1, {filled(good), filled(bad), {}, filled(third)}}});
  };
  EXPECT_THAT(summary(0.10001, 0.4, 0.10002), AllOf(HasSubstr("| Good | **0.1000** |"), HasSubstr("| Third | **0.1000** |")));
  EXPECT_THAT(summary(0.10001, 0.1, 0.10002), Not(HasSubstr("**")));
}

// ---- Pixels as text -----------------------------------------------------------------------------------------------------

TEST(ReportPack, Base64IsThatOfTheStandard) {
  const auto encoded = [](std::string_view text) {
    return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xff\xfe\xfb"), "//77");
}

std::vector<std::uint8_t> unpacked(const std::string& text, std::size_t bytes) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> packed;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = group << 6 | static_cast<std::uint32_t>(digits.find(c));
    if ((bits += 6) >= 8) packed.push_back(static_cast<std::uint8_t>(group >> (bits -= 8)));
  }
  std::vector<std::uint8_t> out(bytes);
  uLongf size = bytes;
  EXPECT_EQ(uncompress(out.data(), &size, packed.data(), packed.size()), Z_OK);
  EXPECT_EQ(size, bytes);
  return out;
}

float from_half(std::uint16_t h) {
  const int exponent = h >> 10 & 31, mantissa = h & 1023;
  const double size = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
  return static_cast<float>(h & 0x8000 ? -size : size);
}

TEST(ReportPack, HalvesComeBack) {
  Image image(37, 11, {"R", "G", "B"});
  std::mt19937 random(5);
  std::uniform_real_distribution<float> exponent(-20, 15), sign(-1, 1);
  for (float& x : image.pixels) x = std::copysign(std::exp2(exponent(random)), sign(random));
  image.pixels[0] = 1e9f;  // beyond the halves
  const std::size_t pixels = 37 * 11, count = 3 * pixels;
  const std::vector<std::uint8_t> bytes = unpacked(pack_halves(image), 2 * count);
  std::uint16_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    value = static_cast<std::uint16_t>(value + (bytes[i] << 8 | bytes[i + count]));
    const float expected = std::clamp(image.pixels[i % pixels * 3 + i / pixels], -65504.f, 65504.f);
    EXPECT_NEAR(from_half(value), expected, std::max(std::abs(expected) * 0x1p-11f, 0x1p-25f));
  }
}

TEST(ReportPack, BytesComeBack) {
  Image image(300, 1, {"error"});
  for (int i = 0; i < 300; ++i) *image.at(i, 0) = static_cast<float>(i) / 255 - 0.05f;
  const std::vector<std::uint8_t> bytes = unpacked(pack_bytes(image), 300);
  std::uint8_t value = 0;
  for (int i = 0; i < 300; ++i) {
    value = static_cast<std::uint8_t>(value + bytes[static_cast<std::size_t>(i)]);
    EXPECT_EQ(value, std::lround(255 * std::clamp(*image.at(i, 0), 0.f, 1.f)));
  }
}

TEST(ReportThumbnail, IsSmallAndKeepsTheMean) {
  Image image(400, 200, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = i / 3 % 2 ? 0.5f : 0.f;  // columns of 0 and 0.5
  const Image small = thumbnail(image, ToneMap::kNone);
  EXPECT_EQ(small.width, kThumbnailSide);
  EXPECT_EQ(small.height, kThumbnailSide / 2);
  double mean = 0;
  for (const float x : small.pixels) mean += std::pow((x + 0.055) / 1.055, 2.4) / static_cast<double>(small.pixels.size());
  EXPECT_NEAR(mean, 0.25, 0.005);
}

// ---- The folder -----------------------------------------------------------------------------------------------------------

TEST_F(Report, PageHasAllThatItNeeds) {
  write_pictures();
  Json json = valid();
  json["title"] = "{{data}} <b> & \"quotes\"";
  json["cases"][0]["title"] = "</script><script>alert(1)</script>";
  const Cases cases = read(json);
  PageWriter page(cases, in("out/"));
  for (const Case& c : cases.cases) page.add(measure(cases, c));
  EXPECT_FALSE(fs::exists(in("out"))) << "nothing appears before the report is whole";
  page.finish();
  const std::string html = slurp(in("out/index.html"));
  EXPECT_THAT(html, HasSubstr("<title>{{data}} &lt;b&gt; &amp; &quot;quotes&quot;</title>"));
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(html.find("http://www.w3.org/2000/svg"), html.rfind("http")) << "no address but the name of SVG";
  for (const char* file : {"cases/0.js", "cases/1.js", "thumbs/0-0.png", "thumbs/0-0-error.png", "thumbs/1-1.png"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
  EXPECT_FALSE(fs::exists(in("out/thumbs/0-2-error.png"))) << "the reference has no error";
  EXPECT_THAT(slurp(in("out/cases/1.js")), testing::StartsWith("pelage.receive(1, [{"));
}

TEST_F(Report, FailureLeavesNothing) {
  write_pictures();
  const Cases cases = read(valid());
  const std::vector<std::string> before = names();
  {
    PageWriter page(cases, in("out"));
    page.add(measure(cases, cases.cases[0]));
  }
  EXPECT_EQ(names(), before);
}

TEST_F(Report, ReplacesReportsAndNothingElse) {
  write_pictures();
  const Cases cases = read(valid());
  const auto write = [&](const std::string& name) {
    PageWriter page(cases, in(name));
    for (const Case& c : cases.cases) page.add(measure(cases, c));
    page.finish();
  };
  write("out");
  std::ofstream(in("out/old.txt")) << "of the last report";
  write("out");
  EXPECT_FALSE(fs::exists(in("out/old.txt")));
  fs::create_directories(in("empty"));
  write("empty");
  EXPECT_TRUE(fs::exists(in("empty/index.html")));
  fs::create_directories(in("mine"));
  std::ofstream(in("mine/index.html")) << "<html>my own page</html>";
  EXPECT_THAT(message_of([&] { write("mine"); }), HasSubstr("is no report"));
  EXPECT_EQ(slurp(in("mine/index.html")), "<html>my own page</html>");
  EXPECT_THAT(message_of([&] { write("truth.exr"); }), HasSubstr("is no report"));
  EXPECT_THAT(names(), ElementsAre("bad.exr", "cases.json", "empty", "good.exr", "mine", "out", "truth.exr"));
}

TEST(ReportPage, TextIsSafeInMarkup) {
  EXPECT_EQ(html_escaped("a<b>&\"c\""), "a&lt;b&gt;&amp;&quot;c&quot;");
  const nlohmann::ordered_json json = {"</script>", "<!--", "ü\u2028"};
  const std::string text = script_safe(json);
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::ordered_json::parse(text), json);
}

}  // namespace
}  // namespace pelage::report
