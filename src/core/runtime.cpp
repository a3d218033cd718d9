#include <pelage/error.h>
#include <pelage/runtime.h>

#include <hwy/highway.h>
#include <tbb/global_control.h>

#include <memory>
#include <mutex>
#include <thread>

#include "core/parallel.h"

namespace pelage {
namespace {

struct Arena {
  std::mutex mutex;
  int threads = 0;
  std::unique_ptr<tbb::global_control> limit;  // lets more threads than cores run: TBB would warn on standard error
  std::unique_ptr<tbb::task_arena> arena;
};
Arena& state() {
  static Arena s;
  return s;
}

// Targets that the kernels are compiled for: see HWY_DISABLED_TARGETS in cmake/PelageOptions.cmake.
constexpr std::int64_t kTargets[] = {HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_EMU128, HWY_SCALAR};

}  // namespace

void set_thread_count(int threads) {
  if (threads < 0) throw Error("threads", "", "a negative number", "give 0 for one thread per core, or a positive number");
  Arena& s = state();
  const std::lock_guard lock(s.mutex);
  s.threads = threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  s.limit =
      std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(s.threads));
  s.arena = std::make_unique<tbb::task_arena>(s.threads);
}

int thread_count() {
  arena();
  return state().threads;
}

tbb::task_arena& arena() {
  Arena& s = state();
  {
    const std::lock_guard lock(s.mutex);
    if (s.arena) return *s.arena;
  }
  set_thread_count(0);
  return *s.arena;
}

std::vector<std::string> available_isas() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> found;
    for (const std::int64_t target : kTargets)
      if (hwy::SupportedTargets() & HWY_TARGETS & target) found.emplace_back(hwy::TargetName(target));
    return found;
  }();
  return names;
}

namespace {
std::string& chosen_isa() {
  static std::string isa;
  return isa;
}
}  // namespace

void set_isa(const std::string& isa) {
  const std::vector<std::string> names = available_isas();
  if (isa.empty()) {
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    chosen_isa().clear();
    return;
  }
  for (const std::int64_t target : kTargets) {
    if (isa != hwy::TargetName(target)) continue;
    for (const std::string& name : names) {
      if (name != isa) continue;
      hwy::SetSupportedTargetsForTest(target);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      chosen_isa() = isa;
      return;
    }
  }
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  throw Error("isa", isa, "unknown instruction set, or not available on this processor", "available: " + list);
}

std::string active_isa() {
  if (!chosen_isa().empty()) return chosen_isa();
  return available_isas().front();
}

const char* version() { return PELAGE_VERSION; }

}  // namespace pelage
