// The chain of thick hairs in a `.pelage` file: sections beside those of the strands. docs/formats.md has the table.
#pragma once

#include <pelage/lod.h>

#include <cstdint>
#include <string_view>

#include "io/atomic_file.h"
#include "io/byte_source.h"
#include "io/pelage_container.h"

namespace pelage::io {

/// Section `lodhead`. The counts say what the other sections have to hold.
struct LodHead {
  std::uint32_t version = 0;
  std::uint32_t points = 0;  ///< of a thick hair
  std::uint32_t levels = 0, hairs = 0, prisms = 0, guides = 0;
  std::uint64_t strands_checksum = 0;  ///< of section `points`: the strands that the chain was built for
};
static_assert(sizeof(LodHead) == 32);

/// Whether a section is one of the chain's, of this version or another.
bool is_lod_section(std::string_view name);

LodHead lod_head(const LodHierarchy& lod, std::uint64_t strands_checksum);
/// `lod` and `head` must live until the writer is done.
void add_lod_sections(const LodHierarchy& lod, const LodHead& head, PelageWriter& writer);

/// The chain of a `.pelage` file; empty where there is none, or the file is another one. What comes back satisfies validate().
/// Throws Error naming the section. Untrusted-input safe.
LodHierarchy read_lod(const ByteSource& source, const Progress& progress = {});

/// Strands and, unless null, their chain.
void write_pelage(AtomicFile& file, const StrandSet& set, const LodHierarchy* lod, const Progress& progress);

}  // namespace pelage::io
