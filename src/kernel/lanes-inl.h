// Memory access of control flow that is written once for one lane and for many: the wide half (scalar: lanes_scalar.h).
// Include it after wide-inl.h; no #pragma once, on purpose.
#if defined(PELAGE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGE_LANES_INL_H_
#undef PELAGE_LANES_INL_H_
#else
#define PELAGE_LANES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace pelage {
namespace HWY_NAMESPACE {
namespace wide {

struct Int {
  hn::Vec<IntTag> v;
  HWY_INLINE Int() = default;
  HWY_INLINE Int(hn::Vec<IntTag> a) : v(a) {}                  // NOLINT: implicit like int
  HWY_INLINE Int(std::int32_t s) : v(hn::Set(IntTag(), s)) {}  // NOLINT
};
HWY_INLINE Int operator+(Int a, Int b) { return hn::Add(a.v, b.v); }
HWY_INLINE Int operator-(Int a, Int b) { return hn::Sub(a.v, b.v); }
HWY_INLINE Int operator*(Int a, Int b) { return hn::Mul(a.v, b.v); }

HWY_INLINE Int load(const std::int32_t* p) { return hn::LoadU(IntTag(), p); }
HWY_INLINE void store(Int a, std::int32_t* p) { hn::StoreU(a.v, IntTag(), p); }
HWY_INLINE Float gather(const float* base, Int index) { return hn::GatherIndex(FloatTag(), base, index.v); }
HWY_INLINE Int gather(const std::uint32_t* base, Int index) {
  return hn::BitCast(IntTag(), hn::GatherIndex(UintTag(), base, index.v));
}
/// Values that other threads change meanwhile: each lane is a value that stood there, maybe one that is no longer.
HWY_INLINE Int gather_shared(const std::uint32_t* base, Int index) {
#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_EMU128 || HWY_TARGET == HWY_SCALAR
  HWY_ALIGN std::int32_t at[hn::MaxLanes(IntTag())];
  hn::Store(index.v, IntTag(), at);
  for (std::size_t l = 0; l < hn::Lanes(IntTag()); ++l)
    at[l] = static_cast<std::int32_t>(__atomic_load_n(base + at[l], __ATOMIC_RELAXED));
  return hn::Load(IntTag(), at);
#else
  return gather(base, index);  // one instruction, four bytes at a time
#endif
}
HWY_INLINE Int to_int(Float a) { return hn::ConvertTo(IntTag(), a.v); }
HWY_INLINE Float to_float(Int a) { return hn::ConvertTo(FloatTag(), a.v); }
HWY_INLINE Int select(Mask m, Int a, Int b) { return hn::IfThenElse(hn::RebindMask(IntTag(), m.m), a.v, b.v); }
HWY_INLINE Vec3 splat(pelage::Vec3 v) { return Vec3(v); }

}  // namespace wide
}  // namespace HWY_NAMESPACE
}  // namespace pelage
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
