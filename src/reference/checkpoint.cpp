#include "reference/checkpoint.h"

#include <fmt/format.h>
#include <pelage/error.h>

#include <array>
#include <filesystem>

#include "io/atomic_file.h"
#include "io/byte_source.h"
#include "io/xxh64.h"

namespace pelage {
namespace {

/// Little-endian, as everything that this library runs on. The checksum covers all before it.
struct Header {
  std::array<char, 8> magic{'P', 'L', 'G', 'T', 'R', 'A', 'C', 'E'};
  std::uint32_t version = 2;  ///< also of what the samples are: which paths end, by which numbers
  std::int32_t width = 0, height = 0;
  std::uint32_t pixel_bytes = sizeof(FilmPixel);
  std::uint64_t fingerprint = 0;
  std::uint64_t bounces = 0, lobes = 0;  ///< entries
  double seconds = 0;
};
static_assert(sizeof(Header) == 56);

constexpr const char* kRemedy = "delete the file to start anew, or name another one";

template <class T>
std::uint64_t bytes_of(const std::vector<T>& v) {
  return std::uint64_t{v.size()} * sizeof(T);
}

template <class T>
void read_array(const io::ByteSource& source, std::uint64_t& at, io::Xxh64& sum, std::vector<T>& target) {
  source.read(at, bytes_of(target), target.data(), "sums");
  sum.add(target.data(), bytes_of(target));
  at += bytes_of(target);
}

void check_header(const std::string& path, const Header& h, std::uint64_t fingerprint, const Film& film) {
  const Header expected;
  if (h.magic != expected.magic) throw Error(path, "byte 0", "not the state of a traced picture", kRemedy);
  if (h.version != expected.version || h.pixel_bytes != expected.pixel_bytes)
    throw Error(path, "byte 8", fmt::format("written by another version ({})", h.version), kRemedy);
  if (h.width != film.width || h.height != film.height)
    throw Error(path, "size",
                fmt::format("{} × {} pixels, the picture has {} × {}", h.width, h.height, film.width, film.height), kRemedy);
  if (h.fingerprint != fingerprint || h.bounces != film.bounces.size() || h.lobes != film.lobes.size())
    throw Error(path, "fingerprint", "the state of another picture: scene, settings or layers differ", kRemedy);
}

}  // namespace

void write_checkpoint(const std::string& path, const Film& film, std::uint64_t fingerprint) {
  Header h;
  h.width = film.width, h.height = film.height;
  h.fingerprint = fingerprint;
  h.bounces = film.bounces.size(), h.lobes = film.lobes.size();
  h.seconds = film.seconds;
  io::AtomicFile file(path);
  io::Xxh64 sum;
  const auto write = [&](const void* data, std::uint64_t bytes) {
    file.write(data, bytes);
    sum.add(data, bytes);
  };
  write(&h, sizeof h);
  write(film.pixels.data(), bytes_of(film.pixels));
  write(film.bounces.data(), bytes_of(film.bounces));
  write(film.lobes.data(), bytes_of(film.lobes));
  file.put(sum.value());
  file.commit();
}

bool read_checkpoint(const std::string& path, std::uint64_t fingerprint, Film& film) {
  if (!std::filesystem::exists(path)) return false;
  const io::ByteSource source = io::ByteSource::open(path);
  const auto h = source.get<Header>(0, "header");
  check_header(path, h, fingerprint, film);
  io::Xxh64 sum;
  sum.add(&h, sizeof h);
  std::uint64_t at = sizeof h;
  Film found = film;
  read_array(source, at, sum, found.pixels);
  read_array(source, at, sum, found.bounces);
  read_array(source, at, sum, found.lobes);
  if (source.get<std::uint64_t>(at, "checksum") != sum.value())
    throw Error(path, fmt::format("byte {}", at), "the checksum does not match: the file is damaged", kRemedy);
  found.seconds = h.seconds;
  film = std::move(found);
  return true;
}

}  // namespace pelage
