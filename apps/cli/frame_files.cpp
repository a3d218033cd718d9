#include "frame_files.h"

#include <fmt/format.h>
#include <fnmatch.h>
#include <pelage/error.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <regex>
#include <string_view>

namespace pelage::cli {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// The run of digits at `at`, without leading zeros.
std::string_view number_at(std::string_view text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && is_digit(text[end])) ++end;
  while (at + 1 < end && text[at] == '0') ++at;
  return text.substr(at, end - at);
}

// frame9 comes before frame10.
bool before_by_numbers(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const std::string_view m = number_at(a, i), n = number_at(b, j);
    if (m.size() != n.size()) return m.size() < n.size();
    if (m != n) return m < n;
    while (i < a.size() && is_digit(a[i])) ++i;
    while (j < b.size() && is_digit(b[j])) ++j;
  }
  return a.size() - i < b.size() - j;
}

std::vector<std::string> files_beside(const fs::path& pattern) {
  std::vector<std::string> names;
  std::error_code error;
  const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    names.push_back(entry->path().filename().string());
  if (error) throw Error(folder.string(), "", error.message(), "the frames are looked for there");
  std::sort(names.begin(), names.end(), before_by_numbers);
  return names;
}

// `name` is what stands before %d, digits, and what stands after it.
std::optional<int> frame_number(const std::string& name, const std::string& before, const std::string& after) {
  if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) return std::nullopt;
  const std::string digits = name.substr(before.size(), name.size() - before.size() - after.size());
  if (digits.size() > 9 || !std::all_of(digits.begin(), digits.end(), is_digit)) return std::nullopt;
  return std::stoi(digits);
}

}  // namespace

std::optional<FrameFiles> frame_files(const std::string& pattern) {
  std::error_code ignored;
  const fs::path path(pattern);
  const std::string name = path.filename().string();
  std::smatch number;
  const bool numbered = std::regex_search(name, number, std::regex("%0?[0-9]*d"));
  if (fs::exists(path, ignored) || (!numbered && name.find_first_of("*?") == std::string::npos)) return std::nullopt;
  FrameFiles frames;
  for (const std::string& file : files_beside(path)) {
    if (numbered) {
      const auto n = frame_number(file, number.prefix(), number.suffix());
      if (!n) continue;
      frames.numbers.push_back(*n);
    } else if (fnmatch(name.c_str(), file.c_str(), FNM_PERIOD) != 0) {
      continue;
    }
    frames.files.push_back((path.parent_path() / file).string());
  }
  if (frames.files.empty())
    throw Error(pattern, "", "no file has such a name", "quote the pattern, so that the shell leaves it alone");
  return frames;
}

void check_same_frames(const std::string& test_pattern, const FrameFiles& test, const std::string& reference_pattern,
                       const FrameFiles& reference) {
  if (!test.numbers.empty() && !reference.numbers.empty()) {
    const auto [t, r] =
        std::mismatch(test.numbers.begin(), test.numbers.end(), reference.numbers.begin(), reference.numbers.end());
    const bool in_test = t != test.numbers.end() && (r == reference.numbers.end() || *t < *r);
    if (in_test)
      throw Error(reference_pattern, fmt::format("frame {}", *t), fmt::format("{} has it, this has not", test_pattern), "");
    if (r != reference.numbers.end())
      throw Error(test_pattern, fmt::format("frame {}", *r), fmt::format("{} has it, this has not", reference_pattern), "");
  }
  if (test.files.size() != reference.files.size())
    throw Error(test_pattern, "",
                fmt::format("{} frames, but {} has {}", test.files.size(), reference_pattern, reference.files.size()),
                "compare sequences of the same length");
}

}  // namespace pelage::cli
