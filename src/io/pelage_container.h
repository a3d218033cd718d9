// The container of `.pelage` files: a header, named sections, a checksum over each. Byte for byte in docs/formats.md.
#pragma once

#include <pelage/progress.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "io/atomic_file.h"
#include "io/byte_source.h"

namespace pelage::io {

// The first byte is no ASCII, the last one a line end: files damaged by text-mode transfers are recognized.
inline constexpr std::array<char, 8> kPelageMagic = {'\x89', 'P', 'E', 'L', 'A', 'G', 'E', '\n'};

struct PelageHeader {
  std::array<char, 8> magic;
  std::uint16_t major, minor;
  std::uint32_t sections;
  std::uint64_t strands, points;
  std::uint32_t basis;
  std::uint32_t points_per_strand;  // 0: they differ, and section `counts` holds them
  std::uint64_t file_size;
  std::uint64_t reserved;
  std::uint64_t checksum;  // of the header up to here and the section table
};
static_assert(sizeof(PelageHeader) == 64);

struct PelageSection {
  std::array<char, 8> name;  // zero-padded
  std::uint32_t element_bytes, components;
  std::uint64_t offset, bytes;
  std::uint64_t checksum;  // of its bytes

  std::string_view title() const {
    return {name.data(), static_cast<std::size_t>(std::find(name.begin(), name.end(), '\0') - name.begin())};
  }
};
static_assert(sizeof(PelageSection) == 40);

/// Whether the bytes begin as a `.pelage` file (a truncated one counts).
bool pelage_magic(const ByteSource& source);

/// Header and sections of a file, each checked before anything is allocated for it.
class PelageReader {
 public:
  /// Reads the header and the table. Throws Error where they do not fit the file.
  PelageReader(const ByteSource& source, const Progress& progress);

  const PelageHeader& header() const { return header_; }
  const ByteSource& source() const { return source_; }
  /// Those that nothing took so far.
  std::vector<std::string> left() const;

  /// The section of that name, which thereby counts as taken; null where there is none. Valid until the next call.
  const PelageSection* take(std::string_view name);

  /// Fills `array` from the section of that name, which has one of `allowed` entries of `components` numbers each. Leaves it
  /// alone where there is none.
  template <class T>
  void read(std::string_view name, std::uint32_t components, std::vector<T>& array,
            std::initializer_list<std::uint64_t> allowed) {
    const PelageSection* section = take(name);
    if (!section) return;
    const std::string place = fmt::format("section {}", name);
    if (section->components != components || section->element_bytes * std::uint64_t{components} != sizeof(T))
      bad(place, fmt::format("{} components of {} bytes", section->components, section->element_bytes));
    const std::uint64_t count = section->bytes / sizeof(T);
    if (section->bytes % sizeof(T) != 0 || std::find(allowed.begin(), allowed.end(), count) == allowed.end())
      bad(place, fmt::format("{} bytes, which make {} entries instead of {}", section->bytes, count, *allowed.begin()));
    array.resize(count);
    read_checked(*section, array.data());
  }

  /// The bytes of a section, against its checksum.
  void read_checked(const PelageSection& section, void* target);

  [[noreturn]] void bad(const std::string& place, const std::string& problem) const;

 private:
  const ByteSource& source_;
  const Progress& progress_;
  PelageHeader header_ = {};
  std::vector<PelageSection> table_;
  PelageSection taken_ = {};
  std::uint64_t read_bytes_ = 0;
};

/// Collects sections; what they refer to must live until write().
class PelageWriter {
 public:
  PelageHeader& header() { return header_; }

  /// `count` items of `components` numbers each; nothing for none.
  void add(std::string_view name, std::uint32_t components, const void* data, std::size_t count, std::size_t item_bytes);
  template <class T>
  void add(std::string_view name, std::uint32_t components, const std::vector<T>& array) {
    add(name, components, array.data(), array.size(), sizeof(T));
  }

  /// Checksum of a section that was added.
  std::uint64_t checksum(std::string_view name) const;

  void write(AtomicFile& file, const Progress& progress);

 private:
  void lay_out();

  PelageHeader header_ = {};
  std::vector<PelageSection> table_;
  std::vector<const void*> payloads_;
};

}  // namespace pelage::io
