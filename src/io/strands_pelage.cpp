// Our own binary format: lossless, versioned, every section checksummed. Byte for byte in docs/formats.md.
#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "io/strand_formats.h"
#include "io/told.h"
#include "io/xxh64.h"

namespace pelage::io {
namespace {

// The first byte is no ASCII, the last one a line end: files damaged by text-mode transfers are recognized.
constexpr std::array<char, 8> kMagic = {'\x89', 'P', 'E', 'L', 'A', 'G', 'E', '\n'};
constexpr std::uint16_t kMajor = 1, kMinor = 0;
constexpr std::uint64_t kAlignment = 64;
constexpr std::uint32_t kMaxSections = 256;
constexpr std::size_t kChunk = 4 << 20;

struct Header {
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
static_assert(sizeof(Header) == 64);

struct Section {
  std::array<char, 8> name;  // zero-padded
  std::uint32_t element_bytes, components;
  std::uint64_t offset, bytes;
  std::uint64_t checksum;  // of its bytes
};
static_assert(sizeof(Section) == 40);

std::array<char, 8> padded(std::string_view name) {
  std::array<char, 8> out = {};
  std::copy(name.begin(), name.end(), out.begin());
  return out;
}

std::string_view unpadded(const std::array<char, 8>& name) {
  return {name.data(), static_cast<std::size_t>(std::find(name.begin(), name.end(), '\0') - name.begin())};
}

std::uint64_t table_checksum(const Header& header, const std::vector<Section>& table) {
  Xxh64 hash;
  hash.add(&header, offsetof(Header, checksum));
  hash.add(table.data(), table.size() * sizeof(Section));
  return hash.value();
}

// Calls visit(name, components, array) for every array of a StrandSet that is stored as it stands.
template <class Set, class Visit>
void for_each_array(Set& set, const Visit& visit) {
  visit("points", 3u, set.points);
  visit("widths", 1u, set.widths);
  visit("colors", 3u, set.colors);
  visit("transp", 1u, set.transparency);
  visit("rootuv", 2u, set.root_uv);
  visit("strandid", 1u, set.strand_id);
  visit("guideid", 1u, set.guide_id);
  visit("group", 1u, set.group);
}

std::string mismatch(const ByteSource& source) {
  std::array<char, 8> head = {};
  const std::size_t n = std::min<std::size_t>(source.size(), head.size());
  source.read(0, n, head.data(), "magic");
  return n >= 4 && std::equal(head.begin(), head.begin() + static_cast<std::ptrdiff_t>(n), kMagic.begin())
             ? ""
             : "does not begin with \\x89PELAGE";
}

class Reader {
 public:
  Reader(const ByteSource& source, const Progress& progress) : source_(source), progress_(progress) {}

  FileStrands read() {
    read_table();
    StrandSet& set = file_.strands;
    set.basis = static_cast<CurveBasis>(header_.basis);
    read_offsets();
    for_each_array(set, [&](std::string_view name, std::uint32_t components, auto& array) {
      read_section(name, components, array, allowed_counts(name));
    });
    if (set.points.size() != header_.points) bad("section points", "missing");
    if (const Section* comment = take("comment")) {
      set.comment.resize(comment->bytes);
      read_checked(*comment, set.comment.data());
    }
    for (const Section& section : table_)
      if (section.name[0] != '\0')
        file_.notes.push_back(fmt::format("section '{}' of a newer Pelage was ignored", unpadded(section.name)));
    file_.scale = 1;
    file_.up_stated = true;
    return std::move(file_);
  }

 private:
  void read_table() {
    header_ = source_.get<Header>(0, "header");
    if (header_.major != kMajor)
      throw Error(source_.name(), "header",
                  fmt::format("format version {}.{}; this program reads {}.x", header_.major, header_.minor, kMajor),
                  "use a newer Pelage");
    if (header_.sections > kMaxSections) bad("header", fmt::format("{} sections announced", header_.sections));
    source_.require(sizeof(Header), header_.sections * sizeof(Section), "section table");
    table_.resize(header_.sections);
    source_.read(sizeof(Header), table_.size() * sizeof(Section), table_.data(), "section table");
    if (table_checksum(header_, table_) != header_.checksum) bad("header", "its checksum does not match");
    if (header_.file_size != source_.size())
      bad("header", fmt::format("{} bytes announced, the file has {}", header_.file_size, source_.size()));
    for (const Section& section : table_)
      source_.require(section.offset, section.bytes, fmt::format("section {}", unpadded(section.name)).c_str());
    if (header_.basis > static_cast<std::uint32_t>(CurveBasis::kBezier))
      bad("header", fmt::format("curve basis {}", header_.basis));
    // Points bound everything that is allocated from the header's counts, and they have to be in the file.
    if (header_.points > UINT32_MAX || header_.points > source_.size() / sizeof(Vec3) || header_.strands > header_.points)
      bad("header", fmt::format("{} strands of {} points announced", header_.strands, header_.points));
  }

  void read_offsets() {
    std::vector<std::uint32_t>& offsets = file_.strands.offsets;
    std::vector<std::uint32_t> counts;
    read_section("counts", 1, counts, {header_.strands});
    if (counts.empty() && header_.strands * header_.points_per_strand != header_.points)
      bad("header", fmt::format("{} strands of {} points each do not make {}", header_.strands, header_.points_per_strand,
                                header_.points));
    offsets.resize(header_.strands + 1);
    std::uint64_t sum = 0;
    for (std::size_t s = 0; s < header_.strands; ++s) {
      sum += counts.empty() ? header_.points_per_strand : counts[s];
      if (sum > header_.points)
        bad(fmt::format("strand {}", s), fmt::format("the strands up to it have {} points, the file {}", sum, header_.points));
      offsets[s + 1] = static_cast<std::uint32_t>(sum);
    }
    if (sum != header_.points) bad("section counts", fmt::format("they make {} points of {}", sum, header_.points));
  }

  std::vector<std::uint64_t> allowed_counts(std::string_view name) const {
    if (name == "points" || name == "transp") return {header_.points};
    if (name == "widths") return {1, header_.points};
    if (name == "colors") return {header_.strands, header_.points};
    return {header_.strands};
  }

  template <class T>
  void read_section(std::string_view name, std::uint32_t components, std::vector<T>& array,
                    const std::vector<std::uint64_t>& allowed) {
    const Section* section = take(name);
    if (!section) return;
    const std::string place = fmt::format("section {}", name);
    if (section->components != components || section->element_bytes * std::uint64_t{components} != sizeof(T))
      bad(place, fmt::format("{} components of {} bytes", section->components, section->element_bytes));
    const std::uint64_t count = section->bytes / sizeof(T);
    if (section->bytes % sizeof(T) != 0 || std::find(allowed.begin(), allowed.end(), count) == allowed.end())
      bad(place, fmt::format("{} bytes for {} strands of {} points", section->bytes, header_.strands, header_.points));
    array.resize(count);
    read_checked(*section, array.data());
  }

  void read_checked(const Section& section, void* target) {
    Xxh64 hash;
    for (std::uint64_t done = 0; done < section.bytes; done += kChunk) {
      const std::size_t n = std::min<std::uint64_t>(kChunk, section.bytes - done);
      char* const to = static_cast<char*>(target) + done;
      source_.read(section.offset + done, n, to, "section");
      hash.add(to, n);
      read_bytes_ += n;
      tell(progress_, "io.read", std::min(1., static_cast<double>(read_bytes_) / static_cast<double>(source_.size())),
           source_.name());
    }
    if (hash.value() != section.checksum)
      bad(fmt::format("section {} at byte {}", unpadded(section.name), section.offset), "its checksum does not match");
  }

  // The section of that name; it leaves the table, so that what remains is unknown.
  const Section* take(std::string_view name) {
    const auto found = std::find_if(table_.begin(), table_.end(), [&](const Section& s) { return s.name == padded(name); });
    if (found == table_.end()) return nullptr;
    taken_ = *found;
    found->name = {};
    return &taken_;
  }

  [[noreturn]] void bad(const std::string& place, const std::string& problem) const {
    throw Error(source_.name(), place, problem, "the file is damaged; export or copy it again");
  }

  const ByteSource& source_;
  const Progress& progress_;
  Header header_ = {};
  std::vector<Section> table_;
  Section taken_ = {};
  FileStrands file_;
  std::uint64_t read_bytes_ = 0;
};

FileStrands read(const ByteSource& source, const Progress& progress) { return Reader(source, progress).read(); }

struct Payload {
  const void* data;
  std::size_t bytes;
};

class Writer {
 public:
  explicit Writer(const StrandSet& set) {
    header_.magic = kMagic;
    header_.major = kMajor, header_.minor = kMinor;
    header_.strands = set.strand_count(), header_.points = set.point_count();
    header_.basis = static_cast<std::uint32_t>(set.basis);
    add_counts(set);
    for_each_array(set, [&](std::string_view name, std::uint32_t components, const auto& array) {
      add(name, components, array.data(), array.size(), sizeof(array[0]));
    });
    add("comment", 1, set.comment.data(), set.comment.size(), 1);
    lay_out();
  }

  void write(AtomicFile& file, const Progress& progress) const {
    file.put(header_);
    file.write(table_.data(), table_.size() * sizeof(Section));
    std::uint64_t at = sizeof(Header) + table_.size() * sizeof(Section);
    for (std::size_t i = 0; i < table_.size(); ++i) {
      static constexpr char kZeros[kAlignment] = {};
      file.write(kZeros, table_[i].offset - at);
      for (std::size_t done = 0; done < payloads_[i].bytes; done += kChunk) {
        tell(progress, "io.write", static_cast<double>(table_[i].offset + done) / static_cast<double>(header_.file_size),
             file.path());
        file.write(static_cast<const char*>(payloads_[i].data) + done, std::min(kChunk, payloads_[i].bytes - done));
      }
      at = table_[i].offset + table_[i].bytes;
    }
  }

 private:
  void add_counts(const StrandSet& set) {
    const std::size_t n = set.strand_count();
    counts_.resize(n);
    for (std::size_t s = 0; s < n; ++s) counts_[s] = set.offsets[s + 1] - set.offsets[s];
    const bool uniform = std::all_of(counts_.begin(), counts_.end(), [&](std::uint32_t c) { return c == counts_[0]; });
    if (uniform) header_.points_per_strand = n ? counts_[0] : 0;
    else add("counts", 1, counts_.data(), n, sizeof counts_[0]);
  }

  void add(std::string_view name, std::uint32_t components, const void* data, std::size_t count, std::size_t item) {
    if (count == 0) return;
    const std::size_t bytes = count * item;
    table_.push_back({padded(name), static_cast<std::uint32_t>(item / components), components, 0, bytes, xxh64(data, bytes)});
    payloads_.push_back({data, bytes});
  }

  void lay_out() {
    std::uint64_t end = sizeof(Header) + table_.size() * sizeof(Section);
    for (Section& section : table_) {
      section.offset = (end + kAlignment - 1) / kAlignment * kAlignment;
      end = section.offset + section.bytes;
    }
    header_.sections = static_cast<std::uint32_t>(table_.size());
    header_.file_size = end;
    header_.checksum = table_checksum(header_, table_);
  }

  Header header_ = {};
  std::vector<Section> table_;
  std::vector<Payload> payloads_;
  std::vector<std::uint32_t> counts_;
};

std::vector<std::string> write(AtomicFile& file, const StrandSet& set, const Progress& progress) {
  Writer(set).write(file, progress);
  return {};
}

}  // namespace

const StrandFormat kPelage = {
    {"pelage", "Pelage binary: everything, checksummed; meters, Y up", {"pelage"}, true, true}, mismatch, read, write};

}  // namespace pelage::io
