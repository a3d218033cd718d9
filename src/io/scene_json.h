// JSON objects told as tables: one entry a key, from which both the reader and the schema come.
//
//   const Fields<Camera>& fields() {
//     static const Fields<Camera> table{
//         vector_field("eye", "Where the camera stands, metres", &Camera::eye, -kFar, kFar).required(), …};
//     return table;
//   }
//   read_object(value, fields(), camera);        // unknown keys, wrong types and ranges throw Error
//   object_schema(fields());                     // the same, as JSON schema
#pragma once

#include <pelage/vec.h>

#include <nlohmann/json.hpp>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace pelage::io {

/// A JSON document that knows the line of every key and element. Throws Error on malformed JSON, on repeated keys and on
/// nesting that no scene has. Memory is proportional to the text.
class JsonDocument {
 public:
  /// `remedy` tells whoever gives malformed JSON what is expected.
  JsonDocument(std::string name, std::vector<char> text, const std::string& remedy);
  const std::string& name() const { return name_; }
  const nlohmann::json& root() const { return root_; }
  /// Of the place that a JSON pointer names, or of what is around it. Reads the text again: for messages.
  int line_of(const std::string& pointer) const;

 private:
  std::string name_;
  std::vector<char> text_;
  nlohmann::json root_;
};

/// A node of a document with its place in it, for messages. Cheap to copy; the document must outlive it.
class JsonValue {
 public:
  explicit JsonValue(const JsonDocument& document) : JsonValue(document, document.root(), "") {}

  const nlohmann::json& node() const { return *node_; }
  JsonValue member(const std::string& key) const { return {*document_, node_->at(key), pointer_ + "/" + key}; }
  std::vector<JsonValue> elements() const;  ///< throws Error where this is no array

  double number(double least, double most) const;
  long long integer(long long least, long long most) const;
  bool boolean() const;
  const std::string& text() const;
  Vec3 vector(double least, double most) const;  ///< three numbers

  /// Error(file, "line 7: /camera/eye", problem, remedy).
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy = "") const;

 private:
  JsonValue(const JsonDocument& document, const nlohmann::json& node, std::string pointer)
      : document_(&document), node_(&node), pointer_(std::move(pointer)) {}
  [[noreturn]] void fail_type(const char* expected) const;

  const JsonDocument* document_;
  const nlohmann::json* node_;
  std::string pointer_;
};

using Schema = nlohmann::ordered_json;

/// One key of an object that describes a T. Keys are read in the order of the table, whatever their order in the file.
template <class T>
struct Field {
  std::string key;
  Schema schema;  ///< with "description"
  std::function<void(const JsonValue&, T&)> read;
  bool is_required = false;

  Field required() && {
    is_required = true;
    return std::move(*this);
  }
};
template <class T>
using Fields = std::vector<Field<T>>;

/// Throws Error where `value` is no object.
void check_is_object(const JsonValue& value);

/// Checks that `value` is an object with the required keys and no others than `known`; throws Error naming the nearest.
void check_keys(const JsonValue& value, const std::vector<std::string>& known, const std::vector<std::string>& required);

template <class T>
void read_object(const JsonValue& value, const Fields<T>& fields, T& out) {
  std::vector<std::string> known, required;
  for (const Field<T>& f : fields) {
    known.push_back(f.key);
    if (f.is_required) required.push_back(f.key);
  }
  check_keys(value, known, required);
  for (const Field<T>& f : fields)
    if (value.node().contains(f.key)) f.read(value.member(f.key), out);
}

template <class T>
Schema object_schema(const Fields<T>& fields) {
  Schema schema{{"type", "object"}, {"additionalProperties", false}};
  for (const Field<T>& f : fields) schema["properties"][f.key] = f.schema;
  for (const Field<T>& f : fields)
    if (f.is_required) schema["required"].push_back(f.key);
  return schema;
}

// Kinds of fields. `scale` turns the file's unit into the member's (degrees into radians).

template <class T>
Field<T> number_field(std::string key, const char* about, float T::*member, double least, double most, double scale = 1) {
  return {std::move(key),
          {{"description", about}, {"type", "number"}, {"minimum", least}, {"maximum", most}},
          [=](const JsonValue& v, T& out) { out.*member = static_cast<float>(v.number(least, most) * scale); }};
}

template <class T, class Integer>
Field<T> integer_field(std::string key, const char* about, Integer T::*member, long long least, long long most) {
  return {std::move(key),
          {{"description", about}, {"type", "integer"}, {"minimum", least}, {"maximum", most}},
          [=](const JsonValue& v, T& out) { out.*member = static_cast<Integer>(v.integer(least, most)); }};
}

template <class T>
Field<T> boolean_field(std::string key, const char* about, bool T::*member) {
  return {std::move(key), {{"description", about}, {"type", "boolean"}}, [=](const JsonValue& v, T& out) {
            out.*member = v.boolean();
          }};
}

template <class T>
Field<T> text_field(std::string key, const char* about, std::string T::*member) {
  return {std::move(key), {{"description", about}, {"type", "string"}}, [=](const JsonValue& v, T& out) {
            out.*member = v.text();
          }};
}

Schema vector_schema(const char* about, double least, double most);

template <class T>
Field<T> vector_field(std::string key, const char* about, Vec3 T::*member, double least, double most) {
  return {std::move(key), vector_schema(about, least, most),
          [=](const JsonValue& v, T& out) { out.*member = v.vector(least, most); }};
}

template <class Enum>
using Names = std::vector<std::pair<std::string, Enum>>;

/// Index of the text of `value` in `names`; throws Error naming the nearest.
std::size_t choice_index(const JsonValue& value, const std::vector<std::string>& names);

template <class Enum>
std::vector<std::string> keys_of(const Names<Enum>& names) {
  std::vector<std::string> keys;
  for (const auto& [name, value] : names) keys.push_back(name);
  return keys;
}

template <class T, class Member, class Enum>
Field<T> choice_field(std::string key, const char* about, Member T::*member, const Names<Enum>& names) {
  const std::vector<std::string> keys = keys_of(names);
  return {std::move(key), {{"description", about}, {"enum", keys}}, [=](const JsonValue& v, T& out) {
            out.*member = names[choice_index(v, keys)].second;
          }};
}

template <class T, class U>
Field<T> object_field(std::string key, const char* about, U T::*member, const Fields<U>& fields) {
  Schema schema = object_schema(fields);
  schema["description"] = about;
  return {std::move(key), std::move(schema), [=, &fields](const JsonValue& v, T& out) { read_object(v, fields, out.*member); }};
}

template <class T, class U>
Field<T> list_field(std::string key, const char* about, std::vector<U> T::*member, const Fields<U>& fields) {
  return {std::move(key),
          {{"description", about}, {"type", "array"}, {"items", object_schema(fields)}},
          [=, &fields](const JsonValue& v, T& out) {
            (out.*member).clear();
            for (const JsonValue& element : v.elements()) read_object(element, fields, (out.*member).emplace_back());
          }};
}

}  // namespace pelage::io
