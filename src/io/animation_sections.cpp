#include "io/animation_sections.h"

#include <pelage/error.h>

namespace pelage::io {
namespace {

constexpr std::uint32_t kVersion = 1;
constexpr const char* kAgain = "simulate it again: pelage simulate";
static_assert(sizeof(Affine) == 12 * sizeof(float));

}  // namespace

bool is_animation_section(std::string_view name) { return name.starts_with("anim"); }

AnimationHead animation_head(const GuideAnimation& animation, std::uint64_t guides_checksum) {
  const std::size_t guides = animation.guides.size() / animation.frames() / LodHierarchy::kPoints;
  return {kVersion,
          static_cast<std::uint32_t>(animation.frames()),
          static_cast<std::uint32_t>(guides),
          animation.first_frame,
          animation.frame_rate,
          0,
          guides_checksum};
}

void add_animation_sections(const GuideAnimation& animation, const AnimationHead& head, PelageWriter& writer) {
  writer.add("animhead", 1, &head, 1, sizeof head);
  writer.add("animguid", 3, animation.guides);
  writer.add("animpose", 12, animation.head);
}

std::shared_ptr<const GuideAnimation> read_animation(PelageReader& file, std::size_t guides, std::uint64_t guides_checksum) {
  std::vector<AnimationHead> heads;
  file.read("animhead", 1, heads, {1});
  if (heads.empty()) return nullptr;
  const AnimationHead& head = heads.front();
  const std::string& name = file.source().name();
  if (head.version != kVersion)
    throw Error(name, "section animhead",
                fmt::format("an animation of version {}; this program reads {}", head.version, kVersion), kAgain);
  if (head.guides != guides || head.guides_checksum != guides_checksum)
    throw Error(name, "section animhead", "the animation was made for other guides", kAgain);
  const auto animation = std::make_shared<GuideAnimation>();
  animation->frame_rate = head.frame_rate, animation->first_frame = head.first_frame;
  file.read("animguid", 3, animation->guides, {std::uint64_t{head.frames} * guides * LodHierarchy::kPoints});
  file.read("animpose", 12, animation->head, {head.frames});
  validate(*animation, guides, name);
  return animation;
}

}  // namespace pelage::io
