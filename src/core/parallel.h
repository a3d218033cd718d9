// Threads. All parallel work of the library goes through here, so that set_thread_count() rules it.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace pelage {

/// The arena that set_thread_count() sizes.
tbb::task_arena& arena();

/// Calls body(begin, end) on disjoint ranges that cover [0, count), of at most `grain` items each.
/// The ranges are the same for any thread count (multiples of `grain`); the order in which they run is not.
template <class Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
  const std::size_t blocks = (count + grain - 1) / grain;
  arena().execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 1), [&](const tbb::blocked_range<std::size_t>& r) {
      for (std::size_t b = r.begin(); b != r.end(); ++b)
        body(b * grain, (b + 1) * grain < count ? (b + 1) * grain : count);
    });
  });
}

}  // namespace pelage
