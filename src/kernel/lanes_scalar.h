// Memory access of control flow that is written once for one lane and for many: the scalar half (wide: lanes-inl.h).
// Code over these names, Float and Mask compiles in both namespaces; it steps through its items lanes() at a time.
#pragma once

#include "kernel/scalar.h"

namespace pelage::kernel {

using Int = std::int32_t;

inline int lanes() { return 1; }
inline Float load(const float* p) { return *p; }
inline Int load(const std::int32_t* p) { return *p; }
inline void store(Float a, float* p) { *p = a; }
inline void store(Int a, std::int32_t* p) { *p = a; }
inline Float gather(const float* base, Int index) { return base[index]; }
inline Int gather(const std::uint32_t* base, Int index) { return static_cast<Int>(base[index]); }
/// Toward zero; the value must fit.
inline Int to_int(Float a) { return static_cast<Int>(a); }
inline Float to_float(Int a) { return static_cast<Float>(a); }
inline Int select(Mask m, Int a, Int b) { return m ? a : b; }
inline bool any(Mask m) { return m; }
inline Vec3 splat(pelage::Vec3 v) { return v; }

}  // namespace pelage::kernel
