#include "assemble/assemble.h"

#include <algorithm>

#include "assemble/assemble_wide.h"
#include "assemble/clip.h"
#include "core/check.h"

namespace pelage {
namespace {

void reserve(ScreenBlock& block, std::size_t points) {
  const std::size_t size = points + ScreenBlock::kPadding;
  if (block.x.size() >= size) return;
  for (Buffer<float>* b : {&block.x, &block.y, &block.depth, &block.radius, &block.cap_x, &block.cap_y}) {
    b->resize(size);
    b->fill(1.f);
  }
  block.id.resize(size);
  block.id.fill(ScreenBlock::kNoSegment);
}

}  // namespace

std::size_t assemble_strands(const AssembleJob& job, std::size_t first, std::size_t last, ScreenBlock& block) {
  PELAGE_CHECK(first < last && last <= (job.parts.empty() ? job.strands->strand_count() : job.parts.size()));
  const auto points = [&](std::size_t i) { return std::size_t{part_at(job, i).spans} * job.subdivisions + 1; };
  std::size_t end = first, total = 0;
  do total += points(end++);
  while (end < last && total + points(end) <= kBlockPoints);
  reserve(block, std::max(total, kBlockPoints));
  block.count = 0;
  camera_points(job, first, end, block);
  if (needs_clipping(job, block)) clip(job, block);
  project_points(job, block);
  return end;
}

}  // namespace pelage
