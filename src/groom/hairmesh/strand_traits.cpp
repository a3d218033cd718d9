#include "groom/hairmesh/strand_traits.h"

#include <algorithm>
#include <cmath>

#include "core/rng.h"

namespace pelage {
namespace {

/// Random numbers of a strand, a clump or a bundle: four a draw.
struct Draw {
  float x, y, z, w;
};

enum class Of : std::uint32_t { kBundle, kClump, kStrand, kStrandFrizz };

Draw draw(const HairMesh::Bundle& bundle, Of what, std::uint32_t number) {
  constexpr std::uint32_t kSeed = 0x68616972;
  const RandomBits r = pcg4d(bundle.seed, static_cast<std::uint32_t>(what), number, kSeed);
  return {uniform_from_bits(r.x), uniform_from_bits(r.y), uniform_from_bits(r.z), uniform_from_bits(r.w)};
}

/// Clumps stand in a square pattern of n × n, each off its square's middle at random.
struct Clump {
  Vec2 middle;
  std::uint32_t number;
};

Clump clump_at(const HairMesh::Bundle& bundle, Vec2 uv, float frequency) {
  const float n = std::max(1.f, std::floor(frequency));
  const Vec2 cell(std::min(std::floor(uv.x * n), n - 1), std::min(std::floor(uv.y * n), n - 1));
  const auto number = static_cast<std::uint32_t>(cell.y * n + cell.x);
  const Draw at = draw(bundle, Of::kClump, number);
  return {{(cell.x + 0.25f + 0.5f * at.x) / n, (cell.y + 0.25f + 0.5f * at.y) / n}, number};
}

Vec2 bilinear(const std::array<Vec2, 4>& c, Vec2 p) {
  const Vec2 low = c[0] + (c[1] - c[0]) * p.x, high = c[3] + (c[2] - c[3]) * p.x;
  return low + (high - low) * p.y;
}

/// The operators of a style, looked up once.
struct Operators {
  using Kind = StyleOperator::Kind;
  explicit Operators(const BundleCage& cage)
      : length(cage.find(Kind::kLength)), clump(cage.find(Kind::kClump)), braid(cage.find(Kind::kBraid)),
        wave(cage.find(Kind::kWave)), curl(cage.find(Kind::kCurl)), noise(cage.find(Kind::kNoise)),
        frizz(cage.find(Kind::kFrizz)), taper(cage.find(Kind::kTaper)) {}
  const StyleOperator *length, *clump, *braid, *wave, *curl, *noise, *frizz, *taper;
};

constexpr float kTwoPi = 6.28318531f;

void make_strand(const BundleCage& cage, const Operators& ops, std::uint32_t strand, std::size_t l, StrandTraits& t) {
  const HairMesh::Bundle& bundle = *cage.bundle;
  const Vec2 uv = strand_place(bundle, strand), groom = groom_place(cage, strand);
  const Draw own = draw(bundle, Of::kStrand, strand);
  t.u[l] = uv.x, t.v[l] = uv.y;
  t.groom_u[l] = groom.x, t.groom_v[l] = groom.y;
  t.length[l] = ops.length ? ops.length->amount * (1 - ops.length->variation * own.x) : 1.f;

  const Clump clump = clump_at(bundle, uv, ops.clump ? ops.clump->frequency : 1.f);
  // What swings or curls does so with its clump, or with its bundle where there are none.
  const Draw lock = ops.clump ? draw(bundle, Of::kClump, clump.number) : draw(bundle, Of::kBundle, 0);
  t.clump_u[l] = clump.middle.x, t.clump_v[l] = clump.middle.y;
  t.clump[l] = ops.clump ? ops.clump->amount * (1 - ops.clump->variation * lock.z) : 0.f;
  t.braid[l] = ops.braid ? ops.braid->amount * (1 + ops.braid->variation * own.y) : 0.f;

  const float angle = kTwoPi * lock.w;
  const float swing = ops.wave ? ops.wave->amount : 0.f;
  t.wave_phase[l] = lock.z + (ops.wave ? ops.wave->variation * own.y : 0.f);
  t.wave_x[l] = swing * std::cos(angle), t.wave_y[l] = swing * std::sin(angle);
  t.curl_phase[l] = lock.z + (ops.curl ? ops.curl->variation * own.z : 0.f);
  t.noise_phase[l] = ops.noise ? ops.noise->variation * own.w : 0.f;

  const Draw frizz = draw(bundle, Of::kStrandFrizz, strand);
  t.frizz[l] = ops.frizz ? ops.frizz->amount * (1 - ops.frizz->variation * std::sqrt(frizz.w)) : 0.f;
  t.frizz_a[l] = frizz.x, t.frizz_b[l] = frizz.y, t.frizz_c[l] = frizz.z;
  t.tip_width[l] = ops.taper ? ops.taper->amount * (1 - ops.taper->variation * own.w) : 1.f;
}

}  // namespace

Vec2 strand_place(const HairMesh::Bundle& bundle, std::uint32_t strand) {
  // Multiples of the plastic number's inverse and of its square, modulo 1, in units of 2⁻³².
  constexpr std::uint32_t kStepU = 3242174889u, kStepV = 2447445414u;
  const RandomBits start = pcg4d(bundle.seed, 0x75u, 0x76u, 0);
  return {uniform_from_bits(start.x + strand * kStepU), uniform_from_bits(start.y + strand * kStepV)};
}

Vec2 groom_place(const BundleCage& cage, std::uint32_t strand) {
  const Vec2 place = bilinear(cage.root_uv, strand_place(*cage.bundle, strand));
  return {std::clamp(place.x, 0.f, 1.f), std::clamp(place.y, 0.f, 1.f)};
}

void make_traits(const BundleCage& cage, std::uint32_t first, std::size_t count, StrandTraits& traits) {
  const Operators operators(cage);
  for (std::size_t l = 0; l < StrandGroup::kLanes; ++l)
    make_strand(cage, operators, first + static_cast<std::uint32_t>(l < count ? l : 0), l, traits);
}

}  // namespace pelage
