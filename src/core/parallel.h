// Threads. All parallel work of the library goes through here, so that set_thread_count() rules it.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

#ifdef __SANITIZE_THREAD__
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#endif

namespace pelage {

/// The arena that set_thread_count() sizes.
tbb::task_arena& arena();

namespace detail {

#ifdef __SANITIZE_THREAD__
/// The scheduler of thread-sanitizer builds: Debian's TBB is not built with the sanitizer, which then sees no order between
/// a loop and what follows it. Plain threads it understands, so it reports the races of our bodies and nothing else.
template <class Body>
void for_each_block(std::size_t blocks, const Body& body) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr error;
  std::mutex mutex;
  const auto work = [&] {
    try {
      for (std::size_t b = next++; b < blocks; b = next++) body(b);
    } catch (...) {
      next = blocks;
      const std::lock_guard lock(mutex);
      if (!error) error = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < arena().max_concurrency(); ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
}
#else
template <class Body>
void for_each_block(std::size_t blocks, const Body& body) {
  arena().execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 1), [&](const tbb::blocked_range<std::size_t>& r) {
      for (std::size_t b = r.begin(); b != r.end(); ++b) body(b);
    });
  });
}
#endif

}  // namespace detail

/// Calls body(begin, end) on disjoint ranges that cover [0, count), of at most `grain` items each.
/// The ranges are the same for any thread count (multiples of `grain`); the order in which they run is not.
template <class Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
  detail::for_each_block((count + grain - 1) / grain,
                         [&](std::size_t b) { body(b * grain, (b + 1) * grain < count ? (b + 1) * grain : count); });
}

}  // namespace pelage
