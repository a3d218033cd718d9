// Wide C++ target of the shared kernel source: Float is a vector of lanes, compiled once per instruction set.
// Include it from a file that Highway re-includes per target, after hwy/highway.h; no #pragma once, on purpose.
//
//   #undef HWY_TARGET_INCLUDE
//   #define HWY_TARGET_INCLUDE "shade/shade_wide.cpp"
//   #include <hwy/foreach_target.h>
//   #include <hwy/highway.h>
//   #include "kernel/wide-inl.h"
//   HWY_BEFORE_NAMESPACE(); namespace pelage { namespace HWY_NAMESPACE { … wide::Float … } } HWY_AFTER_NAMESPACE();
//
// No fused multiply-add, here or in scalar code (-ffp-contract=off): every target gives the same bits.
#if defined(PELAGE_WIDE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGE_WIDE_INL_H_
#undef PELAGE_WIDE_INL_H_
#else
#define PELAGE_WIDE_INL_H_
#endif

#include <pelage/vec.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace wide {

namespace hn = hwy::HWY_NAMESPACE;
using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<FloatTag>;
using UintTag = hn::RebindToUnsigned<FloatTag>;

#define PELAGE_FN HWY_INLINE
#define PELAGE_EXACT

inline constexpr FloatTag kFloatTag{};
HWY_INLINE int lanes() { return static_cast<int>(hn::Lanes(FloatTag())); }

struct Mask {
  hn::Mask<FloatTag> m;
};
HWY_INLINE Mask operator&&(Mask a, Mask b) { return {hn::And(a.m, b.m)}; }
HWY_INLINE Mask operator||(Mask a, Mask b) { return {hn::Or(a.m, b.m)}; }
HWY_INLINE Mask operator!(Mask a) { return {hn::Not(a.m)}; }
HWY_INLINE bool any(Mask a) { return !hn::AllFalse(FloatTag(), a.m); }

struct Float {
  hn::Vec<FloatTag> v;
  HWY_INLINE Float() = default;
  HWY_INLINE Float(hn::Vec<FloatTag> a) : v(a) {}           // NOLINT: implicit like float
  HWY_INLINE Float(float s) : v(hn::Set(FloatTag(), s)) {}  // NOLINT
};
HWY_INLINE Float load(const float* p) { return Float(hn::LoadU(FloatTag(), p)); }
HWY_INLINE void store(Float a, float* p) { hn::StoreU(a.v, FloatTag(), p); }

HWY_INLINE Float operator+(Float a, Float b) { return hn::Add(a.v, b.v); }
HWY_INLINE Float operator-(Float a, Float b) { return hn::Sub(a.v, b.v); }
HWY_INLINE Float operator*(Float a, Float b) { return hn::Mul(a.v, b.v); }
HWY_INLINE Float operator/(Float a, Float b) { return hn::Div(a.v, b.v); }
HWY_INLINE Float operator-(Float a) { return hn::Neg(a.v); }
HWY_INLINE Mask operator<(Float a, Float b) { return {hn::Lt(a.v, b.v)}; }
HWY_INLINE Mask operator<=(Float a, Float b) { return {hn::Le(a.v, b.v)}; }
HWY_INLINE Mask operator>(Float a, Float b) { return {hn::Gt(a.v, b.v)}; }
HWY_INLINE Mask operator>=(Float a, Float b) { return {hn::Ge(a.v, b.v)}; }
HWY_INLINE Mask operator==(Float a, Float b) { return {hn::Eq(a.v, b.v)}; }

HWY_INLINE Float select(Mask m, Float a, Float b) { return hn::IfThenElse(m.m, a.v, b.v); }
// The second operand where either is NaN, like the scalar target.
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
// Its instructions do just that, in one step instead of two.
HWY_INLINE Float min(Float a, Float b) { return hn::Min(a.v, b.v); }
HWY_INLINE Float max(Float a, Float b) { return hn::Max(a.v, b.v); }
#else
HWY_INLINE Float min(Float a, Float b) { return select(a < b, a, b); }
HWY_INLINE Float max(Float a, Float b) { return select(a > b, a, b); }
#endif
HWY_INLINE Float abs(Float a) { return hn::Abs(a.v); }
HWY_INLINE Float sqrt(Float a) { return hn::Sqrt(a.v); }
HWY_INLINE Float floor(Float a) { return hn::Floor(a.v); }
HWY_INLINE Float ceil(Float a) { return hn::Ceil(a.v); }
HWY_INLINE Float pow2i(Float n) {
  const IntTag di;
  const auto i = hn::Add(hn::ConvertTo(di, n.v), hn::Set(di, 127));
  return hn::BitCast(FloatTag(), hn::ShiftLeft<23>(i));
}
HWY_INLINE Float exponent_of(Float x) {
  const IntTag di;
  const auto e = hn::BitCast(di, hn::ShiftRight<23>(hn::BitCast(UintTag(), x.v)));
  return hn::ConvertTo(FloatTag(), hn::Sub(e, hn::Set(di, 127)));
}
HWY_INLINE Float mantissa_of(Float x) {
  const UintTag du;
  const auto bits = hn::And(hn::BitCast(du, x.v), hn::Set(du, 0x007fffffu));
  return hn::BitCast(FloatTag(), hn::Or(bits, hn::Set(du, 0x3f800000u)));
}

struct Vec2 {
  Float x, y;
  HWY_INLINE Vec2() = default;
  HWY_INLINE Vec2(Float a, Float b) : x(a), y(b) {}
};
HWY_INLINE Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
HWY_INLINE Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
HWY_INLINE Vec2 operator*(Vec2 a, Float s) { return {a.x * s, a.y * s}; }
HWY_INLINE Float dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
HWY_INLINE Vec2 select(Mask m, Vec2 a, Vec2 b) { return {select(m, a.x, b.x), select(m, a.y, b.y)}; }

struct Vec3 {
  Float x, y, z;
  HWY_INLINE Vec3() = default;
  HWY_INLINE Vec3(Float a, Float b, Float c) : x(a), y(b), z(c) {}
  HWY_INLINE Vec3(pelage::Vec3 a) : x(a.x), y(a.y), z(a.z) {}  // NOLINT: uniform values broadcast
};
HWY_INLINE Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
HWY_INLINE Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
HWY_INLINE Vec3 operator*(Vec3 a, Float s) { return {a.x * s, a.y * s, a.z * s}; }
HWY_INLINE Vec3 operator*(Float s, Vec3 a) { return {a.x * s, a.y * s, a.z * s}; }
HWY_INLINE Vec3 operator/(Vec3 a, Vec3 b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }
HWY_INLINE Vec3 operator/(Vec3 a, Float s) { return {a.x / s, a.y / s, a.z / s}; }
HWY_INLINE Float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
HWY_INLINE Vec3 select(Mask m, Vec3 a, Vec3 b) { return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)}; }

struct Vec4 {
  Float x, y, z, w;
  HWY_INLINE Vec4() = default;
  HWY_INLINE Vec4(Float a, Float b, Float c, Float d) : x(a), y(b), z(c), w(d) {}
};

#include "kernel/kernels.inc"

#undef PELAGE_EXACT
#undef PELAGE_FN

}  // namespace wide
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
