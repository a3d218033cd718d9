#include "report/cases.h"

#include <fmt/format.h>
#include <pelage/error.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/nearest.h"
#include "io/byte_source.h"
#include "io/scene_json.h"

namespace pelage::report {
namespace {

using namespace io;

constexpr double kFar = 1e9;

// An object of any keys, whose values are words or numbers.
template <class T, class Add>
Field<T> map_field(std::string key, const char* about, Add add) {
  return {std::move(key),
          {{"description", about}, {"type", "object"}, {"additionalProperties", {{"type", {"string", "number"}}}}},
          [=](const JsonValue& v, T& out) {
            check_is_object(v);
            for (const auto& [name, node] : v.node().items()) add(v.member(name), name, out);
          }};
}

template <class T>
Field<T> names_field(std::string key, const char* about, std::vector<std::string> T::*member) {
  return {std::move(key),
          {{"description", about}, {"type", "array"}, {"items", {{"type", "string"}}}},
          [=](const JsonValue& v, T& out) {
            for (const JsonValue& element : v.elements()) (out.*member).push_back(element.text());
          }};
}

std::string shown(const JsonValue& v) { return v.node().is_number() ? v.node().dump() : v.text(); }

const Fields<Method>& method_fields() {
  static const Fields<Method> table{
      text_field("name", "As images name it", &Method::name).required(),
      text_field("label", "As the page shows it; the name without it", &Method::label),
      text_field("series", "Methods of one series are joined by a line in plots", &Method::series),
      text_field("about", "A sentence for readers", &Method::about),
  };
  return table;
}

const Fields<Entry>& entry_fields() {
  static const Fields<Entry> table{
      text_field("method", "Who made it; one of `methods` where that list is given", &Entry::method).required(),
      text_field("file", "EXR, HDR or PNG, relative to this file", &Entry::file).required(),
      text_field("command", "What makes the file again", &Entry::command),
      number_field("time", "Seconds that it took", &Entry::seconds, 0, kFar),
      integer_field("samples", "Per pixel", &Entry::samples, 0, 1 << 30),
      map_field<Entry>("values", "Numbers that were measured elsewhere; named in the list `values` of the report",
                       [](const JsonValue& v, const std::string& name, Entry& out) {
                         out.values.emplace_back(name, v.number(-kFar, kFar));
                       }),
  };
  return table;
}

const Fields<Case>& case_fields() {
  static const Fields<Case> table{
      text_field("title", "Of the page of this case", &Case::title).required(),
      text_field("about", "A sentence for readers", &Case::about),
      map_field<Case>("axes", "Where it stands among the cases, e.g. {\"hairstyle\": \"curly\", \"distance\": 2.5}",
                      [](const JsonValue& v, const std::string& name, Case& out) {
                        AxisValue value{name, shown(v), {}};
                        if (v.node().is_number()) value.number = v.number(-kFar, kFar);
                        out.axes.push_back(std::move(value));
                      }),
      map_field<Case>(
          "settings", "What all its pictures have in common, for readers",
          [](const JsonValue& v, const std::string& name, Case& out) { out.settings.emplace_back(name, shown(v)); }),
      text_field("reference", "Method that the others are measured against", &Case::reference),
      text_field("mask", "Picture whose first channel is above 0 on hair; without it the channel `coverage` of the reference",
                 &Case::mask),
      list_field("images", "A picture a method, the reference among them", &Case::images, entry_fields()).required(),
  };
  return table;
}

const Fields<ExtraMetric>& extra_fields() {
  static const Names<ExtraMetric::Better> directions{{"lower", ExtraMetric::Better::kLower},
                                                     {"higher", ExtraMetric::Better::kHigher}};
  static const Fields<ExtraMetric> table{
      text_field("name", "As images and the page call it", &ExtraMetric::name).required(),
      text_field("about", "A sentence for readers", &ExtraMetric::about),
      choice_field("better", "Which way is better", &ExtraMetric::better, directions),
  };
  return table;
}

const Fields<Cases>& report_fields() {
  static const std::vector<std::string> curves{"aces", "none"};
  static const Fields<Cases> table{
      text_field("$schema", "For editors", &Cases::schema),
      text_field("title", "Of the whole report", &Cases::title),
      text_field("about", "What it shows, a sentence or two", &Cases::about),
      text_field("machine", "Where times were taken", &Cases::machine),
      {"tone_map",
       {{"description", "Curve from scene-linear to display; without it aces, and none for PNG"}, {"enum", curves}},
       [](const JsonValue& v, Cases& out) { out.tone_map = choice_index(v, curves) == 0 ? ToneMap::kAces : ToneMap::kNone; }},
      number_field("exposure", "Stops, before the curve; of scene-linear pictures", &Cases::exposure, -100, 100),
      names_field("axes", "Names of the axes of the cases, in the order of the page", &Cases::axes),
      list_field("methods", "Names, labels and order of the methods", &Cases::methods, method_fields()),
      list_field("values", "Metrics that were measured elsewhere", &Cases::values, extra_fields()),
      text_field("reference", "Reference of every case that names none itself", &Cases::reference),
      list_field("cases", "The same scene by several methods, each", &Cases::cases, case_fields()).required(),
  };
  return table;
}

// What one key cannot know of another.
class Completer {
 public:
  explicit Completer(Cases& cases) : cases_(cases) {}

  void complete() {
    if (cases_.cases.empty()) fail("/cases", "no case", "give at least one");
    complete_methods();
    complete_axes();
    for (const ExtraMetric& value : cases_.values) require_new(values_, value.name, "/values", "is told twice");
    for (std::size_t i = 0; i < cases_.cases.size(); ++i) complete(cases_.cases[i], place_of(i));
  }

 private:
  using NameList = std::vector<std::string>;

  [[noreturn]] void fail(const std::string& place, const std::string& problem, const std::string& remedy) const {
    throw Error(cases_.path, place, problem, remedy);
  }
  std::string place_of(std::size_t i) const { return fmt::format("case \"{}\" (/cases/{})", cases_.cases[i].title, i); }

  void require_new(NameList& names, const std::string& name, const std::string& place, const char* problem) const {
    if (std::find(names.begin(), names.end(), name) != names.end())
      fail(place, fmt::format("`{}` {}", name, problem), "keep one");
    names.push_back(name);
  }
  void require_known(const NameList& names, const std::string& name, const std::string& place, const char* what) const {
    if (std::find(names.begin(), names.end(), name) == names.end())
      fail(place, fmt::format("no {} has the name `{}`", what, name),
           names.empty() ? "none is there" : fmt::format("did you mean `{}`?", nearest_name(name, names)));
  }

  // Without a list of methods, those of the images in the order of their first occurrence.
  void complete_methods() {
    const bool listed = !cases_.methods.empty();
    for (const Method& method : cases_.methods) require_new(methods_, method.name, "/methods", "is told twice");
    for (const Case& c : cases_.cases)
      for (const Entry& image : c.images)
        if (!listed && std::find(methods_.begin(), methods_.end(), image.method) == methods_.end()) {
          methods_.push_back(image.method);
          cases_.methods.push_back({image.method, "", "", ""});
        }
    for (Method& method : cases_.methods) {
      if (method.label.empty()) method.label = method.name;
      if (method.series.empty()) method.series = method.label;
    }
  }

  void complete_axes() {
    const bool listed = !cases_.axes.empty();
    NameList axes;
    for (const std::string& axis : cases_.axes) require_new(axes, axis, "/axes", "is told twice");
    for (std::size_t i = 0; i < cases_.cases.size(); ++i)
      for (const AxisValue& value : cases_.cases[i].axes) {
        if (listed) require_known(axes, value.axis, place_of(i), "axis");
        else if (std::find(axes.begin(), axes.end(), value.axis) == axes.end()) axes.push_back(value.axis);
      }
    cases_.axes = axes;
  }

  void complete(Case& c, const std::string& place) const {
    NameList here;
    for (const Entry& image : c.images) {
      require_known(methods_, image.method, place, "method");
      require_new(here, image.method, place, "has two images");
      for (const auto& [name, value] : image.values) require_known(values_, name, place, "metric of the list `values`");
    }
    if (c.images.size() < 2)
      fail(place, fmt::format("{} images", c.images.size()), "give the reference and one to compare with it");
    if (c.reference.empty()) c.reference = cases_.reference;
    if (c.reference.empty()) fail(place, "no reference", "name a method with the key `reference`");
    require_known(here, c.reference, place, "image of this case");
  }

  Cases& cases_;
  NameList methods_, values_;
};

}  // namespace

std::string Cases::file(const std::string& name) const { return (std::filesystem::path(path).parent_path() / name).string(); }

Cases read_cases(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 64u << 20;
  const ByteSource source = ByteSource::open(path);
  if (source.size() > kMostBytes) throw Error(path, "", "more than 64 MiB of JSON", "is it the list of cases?");
  const JsonDocument document(path, source.read_all(), "a list of cases is JSON; see docs/report.schema.json");
  Cases cases;
  cases.path = path;
  read_object(JsonValue(document), report_fields(), cases);
  Completer(cases).complete();
  return cases;
}

std::string cases_schema() {
  Schema schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                {"title", "Cases of a Pelage report"},
                {"description", "Input of `pelage report`. Made by `pelage report --schema`."}};
  schema.update(object_schema(report_fields()));
  return schema.dump(2) + "\n";
}

}  // namespace pelage::report
