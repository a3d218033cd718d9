#include "io/scene_json.h"

#include <fmt/format.h>
#include <pelage/error.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <set>

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

// Walks through a document once, with memory for what is open only. Finds the line of one key or element (or of the nearest
// around it: a number in an array has the line of its array, because the parser only knows it once it has read on), the
// first key that is given twice, and nesting that no scene has.
class Walk final : public nlohmann::json_sax<json> {
 public:
  struct Place {
    std::string pointer;
    int line;
  };

  Walk(const std::vector<char>& text, const std::string& sought) : sought_(sought) {
    const char* const begin = text.data();
    const char* const end = begin + text.size();
    json::sax_parse(CountingIterator(begin, &line_), CountingIterator(end, &line_), this);
  }
  int found_line() const { return found_line_; }
  const std::optional<Place>& repeated_key() const { return repeated_; }
  const std::optional<Place>& too_deep() const { return too_deep_; }

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
    Container& object = open_.back();
    path_.resize(object.prefix);
    (path_ += '/') += name;
    compare();
    if (!object.keys.insert(name).second && !repeated_) repeated_ = Place{path_, line_};
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  static constexpr std::size_t kMostOpen = 64;

  struct Container {
    bool is_array;
    std::size_t prefix;  // length of path_ up to the container itself
    std::size_t index = 0;
    std::set<std::string> keys;
  };
  // path_ stands at the sought place or around it; what is met later is nearer.
  void compare() {
    if (path_.size() <= sought_.size() && sought_.starts_with(path_) &&
        (path_.size() == sought_.size() || sought_[path_.size()] == '/'))
      found_line_ = line_;
  }
  bool open(bool is_array) {
    if (!open_.empty() && open_.back().is_array) {
      path_.resize(open_.back().prefix);
      (path_ += '/') += std::to_string(open_.back().index);
      compare();
    }
    if (open_.size() == kMostOpen) too_deep_ = Place{path_, line_};
    open_.push_back({is_array, path_.size(), 0, {}});
    return !too_deep_;
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

  const std::string& sought_;
  int line_ = 1, found_line_ = 1;
  std::vector<Container> open_;
  std::string path_;
  std::optional<Place> repeated_, too_deep_;
};

// "[json.exception.parse_error.101] parse error at line 3, column 5: …" without what a person cannot use.
std::string plain_message(const std::string& what) {
  const std::size_t end = what.find("] ");
  return end == std::string::npos ? what : what.substr(end + 2);
}

}  // namespace

JsonDocument::JsonDocument(std::string name, std::vector<char> text, const std::string& remedy)
    : name_(std::move(name)), text_(std::move(text)) {
  const Walk walk(text_, "");
  if (const auto& deep = walk.too_deep())
    throw Error(name_, fmt::format("line {}", deep->line), "objects and arrays nested too deep", "a scene file is flat");
  try {
    root_ = json::parse(text_.begin(), text_.end());
  } catch (const json::exception& e) {
    throw Error(name_, "", plain_message(e.what()), remedy);
  }
  if (const auto& repeated = walk.repeated_key())
    throw Error(name_, fmt::format("line {}: {}", repeated->line, repeated->pointer), "this key is given twice", "keep one");
}

int JsonDocument::line_of(const std::string& pointer) const { return Walk(text_, pointer).found_line(); }

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

void check_is_object(const JsonValue& value) {
  if (!value.node().is_object()) value.fail(fmt::format("{} where an object is expected", value.node().type_name()));
}

void check_keys(const JsonValue& value, const std::vector<std::string>& known, const std::vector<std::string>& required) {
  check_is_object(value);
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
