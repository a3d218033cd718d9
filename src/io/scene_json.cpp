#include "io/scene_json.h"

#include <fmt/format.h>
#include <pelage/error.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>

#include "core/nearest.h"

namespace pelage::io {
namespace {

using nlohmann::json;

// A character of the text that counts the lines that the parser has gone through.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, int* line) : at_(at), line_(line) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    if (*at_ == '\n') ++*line_;
    ++at_;
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  int* line_;
};

// Notes the line of every key, and of every array element that is a container (a number is only known to the parser
// once it has read on, maybe over a line's end; it has the line of its array). Finds repeated keys.
class LineNotes final : public nlohmann::json_sax<json> {
 public:
  LineNotes(const int& line, std::map<std::string, int>& lines) : line_(line), lines_(lines) {}

  struct Repeated {
    std::string pointer;
    int line;
  };
  const std::optional<Repeated>& repeated_key() const { return repeated_; }

  bool null() override { return next(); }
  bool boolean(bool) override { return next(); }
  bool number_integer(number_integer_t) override { return next(); }
  bool number_unsigned(number_unsigned_t) override { return next(); }
  bool number_float(number_float_t, const string_t&) override { return next(); }
  bool string(string_t&) override { return next(); }
  bool binary(binary_t&) override { return next(); }
  bool start_object(std::size_t) override { return open(false); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    open_.back().key = name;
    if (!lines_.emplace(pointer(), line_).second && !repeated_) repeated_ = Repeated{pointer(), line_};
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  struct Container {
    bool is_array;
    std::size_t index;
    std::string key;
    std::size_t prefix;  // length of path_ without this container's own step
  };
  std::string step() const {
    if (open_.empty()) return "";
    return "/" + (open_.back().is_array ? std::to_string(open_.back().index) : open_.back().key);
  }
  std::string pointer() const { return path_ + step(); }
  bool open(bool is_array) {
    if (!open_.empty() && open_.back().is_array) lines_.emplace(pointer(), line_);
    const std::size_t prefix = path_.size();
    path_ += step();
    open_.push_back({is_array, 0, "", prefix});
    return true;
  }
  bool close() {
    path_.resize(open_.back().prefix);
    open_.pop_back();
    return next();
  }
  bool next() {
    if (!open_.empty() && open_.back().is_array) ++open_.back().index;
    return true;
  }

  const int& line_;
  std::map<std::string, int>& lines_;
  std::vector<Container> open_;
  std::string path_;
  std::optional<Repeated> repeated_;
};

// "[json.exception.parse_error.101] parse error at line 3, column 5: …" without what a person cannot use.
std::string plain_message(const std::string& what) {
  const std::size_t end = what.find("] ");
  return end == std::string::npos ? what : what.substr(end + 2);
}

}  // namespace

JsonDocument::JsonDocument(std::string name, const std::vector<char>& text) : name_(std::move(name)) {
  const char* const begin = text.data();
  const char* const end = begin + text.size();
  try {
    root_ = json::parse(begin, end);
  } catch (const json::exception& e) {
    throw Error(name_, "", plain_message(e.what()), "a scene file is JSON; see docs/scene.schema.json");
  }
  int line = 1;
  LineNotes notes(line, lines_);
  json::sax_parse(CountingIterator(begin, &line), CountingIterator(end, &line), &notes);
  if (const auto& repeated = notes.repeated_key())
    throw Error(name_, fmt::format("line {}: {}", repeated->line, repeated->pointer), "this key is given twice", "keep one");
}

int JsonDocument::line_of(const std::string& pointer) const {
  for (std::string p = pointer; !p.empty(); p.resize(p.rfind('/')))
    if (const auto found = lines_.find(p); found != lines_.end()) return found->second;
  return 1;
}

void JsonValue::fail(const std::string& problem, const std::string& remedy) const {
  const std::string place = fmt::format("line {}: {}", document_->line_of(pointer_), pointer_.empty() ? "/" : pointer_);
  throw Error(document_->name(), place, problem, remedy);
}

void JsonValue::fail_type(const char* expected) const {
  fail(fmt::format("{} where {} is expected", node_->type_name(), expected));
}

std::vector<JsonValue> JsonValue::elements() const {
  if (!node_->is_array()) fail_type("an array");
  std::vector<JsonValue> result;
  for (std::size_t i = 0; i < node_->size(); ++i)
    result.push_back(JsonValue(*document_, (*node_)[i], pointer_ + "/" + std::to_string(i)));
  return result;
}

double JsonValue::number(double least, double most) const {
  if (!node_->is_number()) fail_type("a number");
  const double x = node_->get<double>();
  if (!(x >= least && x <= most)) fail(fmt::format("{} is out of range", x), fmt::format("from {} to {}", least, most));
  return x;
}

long long JsonValue::integer(long long least, long long most) const {
  if (!node_->is_number_integer()) fail_type("a whole number");
  const bool too_big = node_->is_number_unsigned() && node_->get<std::uint64_t>() > static_cast<std::uint64_t>(INT64_MAX);
  const long long x = too_big ? INT64_MAX : node_->get<long long>();
  if (too_big || x < least || x > most)
    fail(fmt::format("{} is out of range", node_->dump()), fmt::format("from {} to {}", least, most));
  return x;
}

bool JsonValue::boolean() const {
  if (!node_->is_boolean()) fail_type("true or false");
  return node_->get<bool>();
}

const std::string& JsonValue::text() const {
  if (!node_->is_string()) fail_type("a string");
  return node_->get_ref<const std::string&>();
}

Vec3 JsonValue::vector(double least, double most) const {
  const std::vector<JsonValue> parts = elements();
  if (parts.size() != 3) fail(fmt::format("{} elements where 3 numbers are expected", parts.size()));
  const auto part = [&](std::size_t i) { return static_cast<float>(parts[i].number(least, most)); };
  return {part(0), part(1), part(2)};
}

void check_keys(const JsonValue& value, const std::vector<std::string>& known, const std::vector<std::string>& required) {
  if (!value.node().is_object()) value.fail(fmt::format("{} where an object is expected", value.node().type_name()));
  for (const auto& [key, member] : value.node().items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      value.member(key).fail(fmt::format("unknown key `{}`", key), fmt::format("did you mean `{}`?", nearest_name(key, known)));
  for (const std::string& key : required)
    if (!value.node().contains(key)) value.fail(fmt::format("the key `{}` is missing", key));
}

std::size_t choice_index(const JsonValue& value, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), value.text());
  if (found == names.end())
    value.fail(fmt::format("unknown value `{}`", value.text()),
               fmt::format("did you mean `{}`?", nearest_name(value.text(), names)));
  return static_cast<std::size_t>(found - names.begin());
}

Schema vector_schema(const char* about, double least, double most) {
  return {{"description", about},
          {"type", "array"},
          {"items", {{"type", "number"}, {"minimum", least}, {"maximum", most}}},
          {"minItems", 3},
          {"maxItems", 3}};
}

}  // namespace pelage::io
