// Threads and instruction sets: how the machine is used, never what comes out.
#pragma once

#include <string>
#include <vector>

namespace pelage {

/// Number of threads that the library uses from now on; 0 means one per core. Results do not depend on it.
void set_thread_count(int threads);
int thread_count();

/// Instruction sets that this build has code for and this processor runs, best first, e.g. {"AVX3","AVX2","SSE4","EMU128"}.
std::vector<std::string> available_isas();
/// Restricts the library to `isa` (and, where a kernel lacks it, a lesser one); "" means the best. Throws Error on unknown names.
void set_isa(const std::string& isa);
std::string active_isa();

/// The library's version, "major.minor.patch".
const char* version();

}  // namespace pelage
