// The animation of a chain's guides in a `.pelage` file: sections beside those of the chain. docs/formats.md has the table.
#pragma once

#include <pelage/animation.h>

#include <cstdint>
#include <memory>
#include <string_view>

#include "io/pelage_container.h"

namespace pelage::io {

/// Section `animhead`. The counts say what the other sections have to hold.
struct AnimationHead {
  std::uint32_t version = 0;
  std::uint32_t frames = 0, guides = 0;
  std::int32_t first_frame = 0;
  float frame_rate = 0;
  std::uint32_t reserved = 0;
  std::uint64_t guides_checksum = 0;  ///< of section `lodguidp`: the guides that were moved
};
static_assert(sizeof(AnimationHead) == 32);

/// Whether a section is one of an animation's, of this version or another.
bool is_animation_section(std::string_view name);

AnimationHead animation_head(const GuideAnimation& animation, std::uint64_t guides_checksum);
/// `animation` and `head` must live until the writer is done.
void add_animation_sections(const GuideAnimation& animation, const AnimationHead& head, PelageWriter& writer);

/// The animation of a file with `guides` guides, whose section `lodguidp` has the checksum; null where there is none. It satisfies
/// validate(). Throws Error naming the section. Untrusted-input safe.
std::shared_ptr<const GuideAnimation> read_animation(PelageReader& file, std::size_t guides, std::uint64_t guides_checksum);

}  // namespace pelage::io
