#include "frame/deferred.h"

#include "core/check.h"

namespace pelage {

UvCells uv_cells(std::size_t i, std::size_t grooms) {
  PELAGE_CHECK(i < grooms && grooms <= std::size_t{kUvCells} * kUvCells);
  std::size_t across = 1;
  while (across * across < grooms) ++across;
  const std::size_t count = kUvCells / across;
  return {static_cast<std::uint32_t>(i % across * count), static_cast<std::uint32_t>(i / across * count),
          static_cast<std::uint32_t>(count)};
}

}  // namespace pelage
