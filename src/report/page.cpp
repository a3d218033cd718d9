#include "report/page.h"

#include <fmt/format.h>
#include <pelage/error.h>
#include <pelage/io.h>
#include <pelage/runtime.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <system_error>

#include "io/atomic_file.h"
#include "report/assets.h"
#include "report/pack.h"
#include "report/thumbnail.h"

namespace pelage::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kIndex = "index.html";
constexpr const char* kMark = "<meta name=\"generator\" content=\"pelage report\">";  // by which a report is known again

[[noreturn]] void fail(const fs::path& path, const char* doing, const std::error_code& error) {
  throw Error(path.string(), "", fmt::format("{}: {}", doing, error.message()), "");
}

bool is_report(const fs::path& folder) {
  std::string head(4096, '\0');
  std::FILE* const file = std::fopen((folder / kIndex).c_str(), "rb");
  if (!file) return false;
  head.resize(std::fread(head.data(), 1, head.size(), file));
  std::fclose(file);
  return head.find(kMark) != std::string::npos;
}

void write_text(const std::string& path, std::string_view text) {
  io::AtomicFile file(path);
  file.write(text);
  file.commit();
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) text.replace(at, from.size(), to);
}

// The template with every {{name}} replaced; what it is replaced by is not searched for names.
std::string filled(std::string_view page, const std::map<std::string, std::string>& parts) {
  std::string text;
  for (std::size_t open; (open = page.find("{{")) != std::string_view::npos;) {
    const std::size_t close = page.find("}}", open);
    text.append(page.substr(0, open)).append(parts.at(std::string(page.substr(open + 2, close - open - 2))));
    page.remove_prefix(close + 2);
  }
  return text.append(page);
}

// JSON knows no infinity: page.js reads the word.
Json told(const Numbers& numbers) {
  Json list = Json::array();
  for (const std::optional<double>& x : numbers) {
    if (!x || std::isnan(*x)) list.push_back(nullptr);
    else if (std::isinf(*x)) list.push_back(*x > 0 ? "Infinity" : "-Infinity");
    else list.push_back(*x);
  }
  return list;
}

Json told(const std::vector<Column>& columns) {
  Json list = Json::array();
  for (const Column& c : columns)
    list.push_back({{"key", c.key}, {"label", c.label}, {"about", c.about}, {"higher", c.higher_is_better}});
  return list;
}

Json told(const std::vector<Method>& methods) {
  Json list = Json::array();
  for (const Method& m : methods)
    list.push_back({{"name", m.name}, {"label", m.label}, {"series", m.series}, {"about", m.about}});
  return list;
}

Json told_axes(const Case& c) {
  Json axes = Json::object();
  for (const AxisValue& value : c.axes) axes[value.axis] = value.number ? Json(*value.number) : Json(value.text);
  return axes;
}

}  // namespace

ReportFolder::ReportFolder(const std::string& path) : path_(fs::absolute(path).lexically_normal()) {
  if (!path_.has_filename()) path_ = path_.parent_path();
  std::error_code error;
  if (fs::exists(path_, error) && !is_report(path_) && !(fs::is_directory(path_, error) && fs::is_empty(path_, error)))
    throw Error(path, "", "stands there and is no report", "name a new folder; a report would replace all of this one");
  temporary_ = path_;
  temporary_ += fmt::format(".{}.part", getpid());
  fs::create_directories(temporary_, error);
  if (error) fail(path_, "cannot be made", error);
}

ReportFolder::~ReportFolder() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void ReportFolder::commit() {
  std::error_code error;
  fs::path old;
  if (fs::exists(path_, error)) {
    old = temporary_;
    old += ".old";
    fs::rename(path_, old, error);
    if (error) fail(path_, "cannot be replaced", error);
  }
  fs::rename(temporary_, path_, error);
  if (error) {
    const std::error_code reason = error;
    if (!old.empty()) fs::rename(old, path_, error);
    fail(path_, "cannot be written", reason);
  }
  temporary_.clear();
  if (!old.empty()) fs::remove_all(old, error);
}

PageWriter::PageWriter(const Cases& cases, const std::string& folder)
    : cases_(cases), columns_(columns(cases)), folder_(folder) {
  fs::create_directories(folder_.file("cases"));
  fs::create_directories(folder_.file("thumbs"));
}

std::string PageWriter::add_thumbnail(const Image& linear, ToneMap curve, const std::string& name) {
  const std::string file = "thumbs/" + name + ".png";
  write_image(folder_.file(file), thumbnail(linear, curve));
  return file;
}

std::string PageWriter::add_error_thumbnail(const Image& error, const std::string& name) {
  const std::string file = "thumbs/" + name + "-error.png";
  write_image(folder_.file(file), error_thumbnail(error));
  return file;
}

void PageWriter::add(const MeasuredCase& measured) {
  const std::size_t number = case_list_.size();
  const Case& c = cases_.cases[number];
  const CaseNumbers& numbers = measured.numbers;
  Json told_case{{"title", c.title},
                 {"about", c.about},
                 {"reference", c.reference},
                 {"axes", told_axes(c)},
                 {"settings", Json::array()},
                 {"width", numbers.width},
                 {"height", numbers.height},
                 {"hairPixels", numbers.hair_pixels},
                 {"toneMap", measured.tone_map == ToneMap::kAces ? "aces" : "none"},
                 {"data", fmt::format("cases/{}.js", number)},
                 {"images", Json::array()}};
  for (const auto& [key, value] : c.settings) told_case["settings"].push_back({key, value});
  Json pixels = Json::array();
  for (std::size_t i = 0; i < c.images.size(); ++i) {
    const Entry& entry = c.images[i];
    const std::string name = fmt::format("{}-{}", number, i);
    const bool has_error = !measured.errors[i].pixels.empty();
    Json image{{"method", entry.method},
               {"file", entry.file},
               {"command", entry.command},
               {"seconds", entry.seconds},
               {"samples", entry.samples},
               {"whole", told(numbers.entries[i].whole)},
               {"hair", told(numbers.entries[i].hair)},
               {"thumb", add_thumbnail(measured.pictures[i], measured.tone_map, name)}};
    if (has_error) image["errorThumb"] = add_error_thumbnail(measured.errors[i], name);
    told_case["images"].push_back(std::move(image));
    pixels.push_back(
        {{"pixels", pack_halves(measured.pictures[i])}, {"error", has_error ? pack_bytes(measured.errors[i]) : ""}});
  }
  write_text(folder_.file(told_case["data"]), fmt::format("pelage.receive({}, {});\n", number, pixels.dump()));
  case_list_.push_back(std::move(told_case));
}

void PageWriter::finish() {
  const Json data{{"title", cases_.title},     {"about", cases_.about},         {"machine", cases_.machine},
                  {"version", version()},      {"axes", cases_.axes},           {"methods", told(cases_.methods)},
                  {"metrics", told(columns_)}, {"errorColors", error_colors()}, {"cases", case_list_}};
  const std::string script = fmt::format("{}\n{}\n{}\n{}\n{}", kPixelsJs, kPlotJs, kViewerJs, kPageJs, kCaseJs);
  const std::string page = filled(kPageHtml, {{"generator", kMark},
                                              {"title", html_escaped(cases_.title)},
                                              {"style", std::string(kPageCss)},
                                              {"script", script},
                                              {"data", script_safe(data)}});
  write_text(folder_.file(kIndex), page);
  folder_.commit();
}

std::string script_safe(const Json& json) {
  std::string text = json.dump(-1, ' ', true);
  replace_all(text, "<", "\\u003c");
  return text;
}

std::string html_escaped(const std::string& text) {
  std::string escaped = text;
  replace_all(escaped, "&", "&amp;");
  replace_all(escaped, "<", "&lt;");
  replace_all(escaped, ">", "&gt;");
  replace_all(escaped, "\"", "&quot;");
  return escaped;
}

}  // namespace pelage::report
