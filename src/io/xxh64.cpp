#include "io/xxh64.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace pelage::io {
namespace {

constexpr std::uint64_t kPrime1 = 0x9E3779B185EBCA87ull, kPrime2 = 0xC2B2AE3D27D4EB4Full, kPrime3 = 0x165667B19E3779F9ull,
                        kPrime4 = 0x85EBCA77C2B2AE63ull, kPrime5 = 0x27D4EB2F165667C5ull;

template <class T>
T load(const unsigned char* data) {
  T value;
  std::memcpy(&value, data, sizeof(T));
  return value;
}

std::uint64_t round(std::uint64_t lane, std::uint64_t input) { return std::rotl(lane + input * kPrime2, 31) * kPrime1; }

std::uint64_t merge(std::uint64_t hash, std::uint64_t lane) { return (hash ^ round(0, lane)) * kPrime1 + kPrime4; }

}  // namespace

void Xxh64::stripe(const unsigned char* data) {
  for (int i = 0; i < 4; ++i) lanes_[i] = round(lanes_[i], load<std::uint64_t>(data + 8 * i));
}

void Xxh64::add(const void* data, std::size_t bytes) {
  if (bytes == 0) return;  // `data` may be null then
  const auto* from = static_cast<const unsigned char*>(data);
  total_ += bytes;
  if (pending_bytes_ > 0) {
    const std::size_t n = std::min(bytes, kStripe - pending_bytes_);
    std::memcpy(pending_ + pending_bytes_, from, n);
    pending_bytes_ += n, from += n, bytes -= n;
    if (pending_bytes_ < kStripe) return;
    stripe(pending_);
    pending_bytes_ = 0;
  }
  for (; bytes >= kStripe; from += kStripe, bytes -= kStripe) stripe(from);
  std::memcpy(pending_, from, bytes);
  pending_bytes_ = bytes;
}

std::uint64_t Xxh64::value() const {
  std::uint64_t hash = kPrime5;
  if (total_ >= kStripe) {
    hash = std::rotl(lanes_[0], 1) + std::rotl(lanes_[1], 7) + std::rotl(lanes_[2], 12) + std::rotl(lanes_[3], 18);
    for (const std::uint64_t lane : lanes_) hash = merge(hash, lane);
  }
  hash += total_;
  const unsigned char* rest = pending_;
  std::size_t left = pending_bytes_;
  for (; left >= 8; rest += 8, left -= 8) hash = std::rotl(hash ^ round(0, load<std::uint64_t>(rest)), 27) * kPrime1 + kPrime4;
  for (; left >= 4; rest += 4, left -= 4)
    hash = std::rotl(hash ^ (load<std::uint32_t>(rest) * kPrime1), 23) * kPrime2 + kPrime3;
  for (; left > 0; ++rest, --left) hash = std::rotl(hash ^ (*rest * kPrime5), 11) * kPrime1;
  hash = (hash ^ (hash >> 33)) * kPrime2;
  hash = (hash ^ (hash >> 29)) * kPrime3;
  return hash ^ (hash >> 32);
}

}  // namespace pelage::io
