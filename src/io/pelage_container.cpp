#include "io/pelage_container.h"

#include <pelage/error.h>

#include "io/told.h"
#include "io/xxh64.h"

namespace pelage::io {
namespace {

constexpr std::uint16_t kMajor = 1, kMinor = 0;
constexpr std::uint64_t kAlignment = 64;
constexpr std::uint32_t kMaxSections = 256;
constexpr std::size_t kChunk = 4 << 20;

std::array<char, 8> padded(std::string_view name) {
  std::array<char, 8> out = {};
  std::copy(name.begin(), name.end(), out.begin());
  return out;
}

std::uint64_t table_checksum(const PelageHeader& header, const std::vector<PelageSection>& table) {
  Xxh64 hash;
  hash.add(&header, offsetof(PelageHeader, checksum));
  hash.add(table.data(), table.size() * sizeof(PelageSection));
  return hash.value();
}

}  // namespace

bool pelage_magic(const ByteSource& source) {
  std::array<char, 8> head = {};
  const std::size_t n = std::min<std::size_t>(source.size(), head.size());
  source.read(0, n, head.data(), "magic");
  return n >= 4 && std::equal(head.begin(), head.begin() + static_cast<std::ptrdiff_t>(n), kPelageMagic.begin());
}

PelageReader::PelageReader(const ByteSource& source, const Progress& progress) : source_(source), progress_(progress) {
  header_ = source_.get<PelageHeader>(0, "header");
  if (header_.major != kMajor)
    throw Error(source_.name(), "header",
                fmt::format("format version {}.{}; this program reads {}.x", header_.major, header_.minor, kMajor),
                "use a newer Pelage");
  if (header_.sections > kMaxSections) bad("header", fmt::format("{} sections announced", header_.sections));
  source_.require(sizeof(PelageHeader), header_.sections * sizeof(PelageSection), "section table");
  table_.resize(header_.sections);
  source_.read(sizeof(PelageHeader), table_.size() * sizeof(PelageSection), table_.data(), "section table");
  if (table_checksum(header_, table_) != header_.checksum) bad("header", "its checksum does not match");
  if (header_.file_size != source_.size())
    bad("header", fmt::format("{} bytes announced, the file has {}", header_.file_size, source_.size()));
  for (const PelageSection& section : table_)
    source_.require(section.offset, section.bytes, fmt::format("section {}", section.title()).c_str());
}

std::vector<std::string> PelageReader::left() const {
  std::vector<std::string> names;
  for (const PelageSection& section : table_)
    if (section.name[0] != '\0') names.emplace_back(section.title());
  return names;
}

const PelageSection* PelageReader::take(std::string_view name) {
  const auto found = std::find_if(table_.begin(), table_.end(), [&](const PelageSection& s) { return s.name == padded(name); });
  if (found == table_.end()) return nullptr;
  taken_ = *found;
  found->name = {};
  return &taken_;
}

void PelageReader::read_checked(const PelageSection& section, void* target) {
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
    bad(fmt::format("section {} at byte {}", section.title(), section.offset), "its checksum does not match");
}

void PelageReader::bad(const std::string& place, const std::string& problem) const {
  throw Error(source_.name(), place, problem, "the file is damaged; export or copy it again");
}

void PelageWriter::add(std::string_view name, std::uint32_t components, const void* data, std::size_t count,
                       std::size_t item_bytes) {
  if (count == 0) return;
  const std::size_t bytes = count * item_bytes;
  table_.push_back(
      {padded(name), static_cast<std::uint32_t>(item_bytes / components), components, 0, bytes, xxh64(data, bytes)});
  payloads_.push_back(data);
}

std::uint64_t PelageWriter::checksum(std::string_view name) const {
  const auto found = std::find_if(table_.begin(), table_.end(), [&](const PelageSection& s) { return s.title() == name; });
  return found == table_.end() ? 0 : found->checksum;
}

void PelageWriter::lay_out() {
  std::uint64_t end = sizeof(PelageHeader) + table_.size() * sizeof(PelageSection);
  for (PelageSection& section : table_) {
    section.offset = (end + kAlignment - 1) / kAlignment * kAlignment;
    end = section.offset + section.bytes;
  }
  header_.magic = kPelageMagic;
  header_.major = kMajor, header_.minor = kMinor;
  header_.sections = static_cast<std::uint32_t>(table_.size());
  header_.file_size = end;
  header_.checksum = table_checksum(header_, table_);
}

void PelageWriter::write(AtomicFile& file, const Progress& progress) {
  lay_out();
  file.put(header_);
  file.write(table_.data(), table_.size() * sizeof(PelageSection));
  std::uint64_t at = sizeof(PelageHeader) + table_.size() * sizeof(PelageSection);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    static constexpr char kZeros[kAlignment] = {};
    file.write(kZeros, table_[i].offset - at);
    for (std::size_t done = 0; done < table_[i].bytes; done += kChunk) {
      tell(progress, "io.write", static_cast<double>(table_[i].offset + done) / static_cast<double>(header_.file_size),
           file.path());
      file.write(static_cast<const char*>(payloads_[i]) + done, std::min<std::size_t>(kChunk, table_[i].bytes - done));
    }
    at = table_[i].offset + table_[i].bytes;
  }
}

}  // namespace pelage::io
