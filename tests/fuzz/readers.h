// One entry per reader: what the fuzz targets and the replay of their findings (tests/regress) both call.
#pragma once

#include <pelage/error.h>
#include <pelage/io.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "io/hair_mesh_formats.h"
#include "io/image_formats.h"
#include "io/lod_sections.h"
#include "io/mesh_formats.h"
#include "io/scene_tables.h"
#include "io/strand_registry.h"
#include "io/xxh64.h"

namespace pelage::fuzz {

/// Any groom: the result must satisfy validate() and have strands, or an Error must have said why not.
inline void read_groom(std::span<const std::byte> bytes) {
  try {
    const StrandSet set = io::read_strands(io::ByteSource("fuzz", bytes), {}, nullptr);
    if (set.strand_count() == 0) std::abort();
    try {
      validate(set, "fuzz");
    } catch (const Error&) {
      std::abort();  // the reader's promise is broken
    }
  } catch (const Error&) {
  }
}

/// The chain of thick hairs of any groom: what comes back satisfies validate(), or an Error has said why not.
inline void read_chain(std::span<const std::byte> bytes) {
  try {
    const LodHierarchy lod = io::read_lod(io::ByteSource("fuzz", bytes));
    try {
      if (!lod.empty()) validate(lod, "fuzz");
    } catch (const Error&) {
      std::abort();  // the reader's promise is broken
    }
  } catch (const Error&) {
  }
}

inline void read_mesh(std::span<const std::byte> bytes) {
  try {
    const TriangleMesh mesh = io::read_mesh(io::ByteSource("fuzz", bytes));
    if (mesh.triangles.empty() || mesh.normals.size() != mesh.positions.size()) std::abort();
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle)
        if (v >= mesh.positions.size()) std::abort();
  } catch (const Error&) {
  }
}

/// Sets the size and the checksums of a `.pelage` file right; where `belongs`, those by which a chain knows its strands too.
inline void seal(std::span<std::byte> bytes, bool belongs = true) {
  constexpr std::size_t kHeader = 64, kSection = 40;  // docs/formats.md
  const auto load = [&](std::size_t at) {
    std::uint64_t value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  };
  const auto store = [&](std::size_t at, std::uint64_t value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
  if (bytes.size() < kHeader) return;
  store(40, bytes.size());
  const std::size_t sections = std::min<std::size_t>(load(12) & 0xFF, (bytes.size() - kHeader) / kSection);
  const auto named = [&](std::size_t at, std::string_view name) { return std::memcmp(bytes.data() + at, name.data(), 8) == 0; };
  std::uint64_t strands = 0, guides = 0;  // checksums of the points and guides, which levels of detail and animation repeat
  for (std::size_t at = kHeader; at < kHeader + sections * kSection; at += kSection) {
    const std::uint64_t offset = load(at + 16), size = load(at + 24);
    if (offset > bytes.size() || size > bytes.size() - offset) continue;
    if (belongs && named(at, {"lodhead\0", 8}) && size == 32) store(offset + 24, strands);
    if (belongs && named(at, {"animhead", 8}) && size == 32) store(offset + 24, guides);
    store(at + 32, io::xxh64(bytes.data() + offset, size));
    if (named(at, {"lodguidp", 8})) guides = load(at + 32);
    if (named(at, {"points\0\0", 8})) strands = load(at + 32);
  }
  io::Xxh64 hash;
  hash.add(bytes.data(), 56);
  hash.add(bytes.data() + kHeader, sections * kSection);
  store(56, hash.value());
}

/// A `.pelage` file made consistent first, so that inputs get past its checksums.
inline void read_sealed_groom(std::span<std::byte> bytes) {
  seal(bytes);
  read_groom(bytes);
  read_chain(bytes);
}

/// Either file of a hair mesh: what comes back satisfies validate(), or an Error has said why not. PELAGE_HAIRMESH=OFF has neither.
inline void read_hair_mesh([[maybe_unused]] std::span<const std::byte> bytes) {
#if PELAGE_HAIRMESH
  try {
    const HairMesh mesh = io::read_hair_mesh(io::ByteSource("fuzz", bytes));
    try {
      validate(mesh, "fuzz");
    } catch (const Error&) {
      std::abort();  // the reader's promise is broken
    }
  } catch (const Error&) {
  }
#endif
}

/// A `.hairmesh` file made consistent first: its size and checksum are set right.
inline void read_sealed_hair_mesh([[maybe_unused]] std::span<std::byte> bytes) {
#if PELAGE_HAIRMESH
  constexpr std::size_t kHeader = 56;  // docs/formats.md
  if (bytes.size() >= kHeader) {
    const std::uint64_t size = bytes.size();
    std::memcpy(bytes.data() + 40, &size, sizeof size);
    const std::uint64_t checksum = io::hair_mesh_checksum({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    std::memcpy(bytes.data() + 48, &checksum, sizeof checksum);
  }
  read_hair_mesh(bytes);
#endif
}

/// A scene file's text alone: nothing that it names is loaded.
inline void read_scene(std::span<const std::byte> bytes) {
  const auto* const text = reinterpret_cast<const char*>(bytes.data());
  try {
    io::read_scene_text("fuzz", std::vector<char>(text, text + bytes.size()));
  } catch (const Error&) {
  }
}

inline void read_png(std::span<const std::byte> bytes) {
  try {
    const Image image = io::read_png(io::ByteSource("fuzz", bytes));
    for (const float x : image.pixels)
      if (!(x >= 0 && x <= 1)) std::abort();
  } catch (const Error&) {
  }
}

inline void read_jpeg(std::span<const std::byte> bytes) {
  try {
    io::read_jpeg(io::ByteSource("fuzz", bytes));
  } catch (const Error&) {
  }
}

inline void read_exr(std::span<const std::byte> bytes) {
  try {
    io::read_exr(io::ByteSource("fuzz", bytes));
  } catch (const Error&) {
  }
}

inline void read_hdr(std::span<const std::byte> bytes) {
  try {
    for (const float x : io::read_hdr(io::ByteSource("fuzz", bytes)).pixels)
      if (!(x >= 0)) std::abort();
  } catch (const Error&) {
  }
}

/// Calls the reader for a corpus file named `<reader>-<anything>`.
inline void replay(std::string_view name, std::span<const std::byte> bytes) {
  if (name.starts_with("mesh")) read_mesh(bytes);
  else if (name.starts_with("hair_mesh")) read_hair_mesh(bytes);
  else if (name.starts_with("scene")) read_scene(bytes);
  else if (name.starts_with("image_png")) read_png(bytes);
  else if (name.starts_with("image_jpeg")) read_jpeg(bytes);
  else if (name.starts_with("image_exr")) read_exr(bytes);
  else if (name.starts_with("image_hdr")) read_hdr(bytes);
  else read_groom(bytes), read_chain(bytes);
}

}  // namespace pelage::fuzz
