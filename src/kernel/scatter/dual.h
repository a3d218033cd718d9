// Dual scattering: Zinke 2008 (references.bib: Zinke2008Dual), as in Huang 2025, section 3.2.
// Derivations, and where we differ: docs/derivations/dual_scattering.md. All variances are of theta_i + theta_o.

const float kDualDensity = 0.7f;        // d_f = d_b, Zinke 2008, section 4.1
const float kBackEdgeSharpness = 6.0f;  // edge of the lit half circle: 10 to 90 % within 2.2/6 rad on both sides

const float kDualAverageMaxAbsError = 6.0e-3f;   // a_f, a_b of scatter_averages against traced rays
const float kAveragedPairMaxMisplaced = 0.035f;  // share of N^G's energy that the exact average has elsewhere

struct ScatterAverages {
  Vec3 a_f;       // mean forward attenuation of a fiber
  Vec3 a_b;       // mean backward attenuation
  Float v_f;      // mean variance of what goes forward, radians^2
  Float v_b;      //   backward
  Float shift_f;  // mean shift, radians
  Float shift_b;
};

// The local backscatter A_B M_B of the hairs around and behind.
struct ScatterBack {
  Vec3 a;            // A_B = A_1 + A_3
  ScatterCone cone;  // its spread and shift, of the mean channel
};

PELAGE_FN Float scatter_mean_channel(Vec3 c) { return (c.x + c.y + c.z) * Float(0.333333333333333f); }

// Fills in the mean variances and shifts of three longitudinal lobes, weighted with what they send forward (f) and
// backward (b). r, tt, trt: (variance, shift) of each.
PELAGE_FN ScatterAverages scatter_mean_cones(ScatterAverages energies, Vec2 r, Float r_f, Float r_b, Vec2 tt, Float tt_f,
                                             Float tt_b, Vec2 trt, Float trt_f, Float trt_b) {
  ScatterAverages a = energies;
  Float inv_f = Float(1.0f) / max(r_f + tt_f + trt_f, Float(1.0e-30f));
  Float inv_b = Float(1.0f) / max(r_b + tt_b + trt_b, Float(1.0e-30f));
  a.v_f = (r_f * r.x + tt_f * tt.x + trt_f * trt.x) * inv_f;
  a.v_b = (r_b * r.x + tt_b * tt.x + trt_b * trt.x) * inv_b;
  a.shift_f = (r_f * r.y + tt_f * tt.y + trt_f * trt.y) * inv_f;
  a.shift_b = (r_b * r.y + tt_b * tt.y + trt_b * trt.y) * inv_b;
  return a;
}
PELAGE_FN Vec2 scatter_spread(ScatterCone c) { return Vec2(c.v, c.shift); }

// Averages over the front and back half circles of the lobes (Zinke 2008, eq. 6). `rest` is isotropic in azimuth.
PELAGE_FN ScatterAverages scatter_averages(ScatterLobes l) {
  ScatterAverages a;
  Vec3 half_rest = l.a_rest * Float(0.5f);
  Vec3 tt_f = l.a_tt * l.front_tt;
  Vec3 trt_f = l.a_trt * l.front_trt;
  Vec3 tt_b = l.a_tt - tt_f;
  Vec3 trt_b = l.a_trt - trt_f;
  Float r_f = l.a_r * l.front_r;
  Float r_b = l.a_r - r_f;
  a.a_f = v_splat(r_f) + tt_f + trt_f + half_rest;
  a.a_b = v_splat(r_b) + tt_b + trt_b + half_rest;
  Float rest = scatter_mean_channel(half_rest);
  return scatter_mean_cones(a, scatter_spread(l.r), r_f, r_b, scatter_spread(l.tt), scatter_mean_channel(tt_f),
                            scatter_mean_channel(tt_b), scatter_spread(l.trt), scatter_mean_channel(trt_f) + rest,
                            scatter_mean_channel(trt_b) + rest);
}

// The same of the lobes of pelekis.h.
PELAGE_FN ScatterAverages scatter_averages_pelekis(ScatterPelekis l) {
  Float even = Float(1.0f) - l.shoulder - l.rim;
  Float r_f =
      l.a_r * (even * Float(kPelekisEvenFront) + l.shoulder * Float(kPelekisShoulderFront) + l.rim * Float(kPelekisRimFront));
  Float r_b = l.a_r - r_f;
  Vec3 half_rest = l.a_rest * Float(0.5f);
  Vec3 tt_f = l.a_tt * scatter_fringe_near(l.n_tt);
  Vec3 trt_b = l.a_trt * scatter_fringe_near(l.n_trt);
  Vec3 tt_b = l.a_tt - tt_f;
  Vec3 trt_f = l.a_trt - trt_b;
  ScatterAverages a;
  a.a_f = v_splat(r_f) + tt_f + trt_f + half_rest;
  a.a_b = v_splat(r_b) + tt_b + trt_b + half_rest;
  Float rest = scatter_mean_channel(half_rest);
  return scatter_mean_cones(a, Vec2(l.r.v, l.r.shift), r_f, r_b, Vec2(l.tt.v, l.tt.shift), scatter_mean_channel(tt_f),
                            scatter_mean_channel(tt_b), Vec2(l.trt.v, l.trt.shift), scatter_mean_channel(trt_f) + rest,
                            scatter_mean_channel(trt_b) + rest);
}

// The same of Sadeghi's lobes: they do not depend on theta.
PELAGE_FN ScatterAverages scatter_averages_sadeghi(ScatterArtist l) {
  Float half_front = Float(kArtistHalfFront);
  Vec3 r_f = l.a_r * half_front;
  Vec3 tt_f = l.a_tt * l.front_tt;
  Vec3 trt_f = l.a_trt * half_front + l.a_glint * l.front_glint;
  Vec3 r_b = l.a_r - r_f;
  Vec3 tt_b = l.a_tt - tt_f;
  Vec3 trt_b = l.a_trt + l.a_glint - trt_f;
  ScatterAverages a;
  a.a_f = r_f + tt_f + trt_f;
  a.a_b = r_b + tt_b + trt_b;
  return scatter_mean_cones(a, scatter_spread(l.r), scatter_mean_channel(r_f), scatter_mean_channel(r_b), scatter_spread(l.tt),
                            scatter_mean_channel(tt_f), scatter_mean_channel(tt_b), scatter_spread(l.trt),
                            scatter_mean_channel(trt_f), scatter_mean_channel(trt_b));
}

// A_B of one channel: one (A_1) or three (A_3) backward events among any number of forward ones.
// Zinke 2008, eq. 11 to 14.
PELAGE_FN Float scatter_back_energy(Float a_f, Float a_b) {
  Float f2 = a_f * a_f;
  Float k = Float(1.0f) / max(Float(1.0f) - f2, Float(1.0e-4f));
  Float a1 = a_b * f2 * k;
  return a1 + a1 * (a_b * k) * (a_b * k);
}

// Zinke 2008, eq. 16 (shift) and 17 (standard deviation), for the mean channel.
PELAGE_FN ScatterBack scatter_back(ScatterAverages m, Float sin_o, Float cos_o) {
  ScatterBack b;
  b.a =
      Vec3(scatter_back_energy(m.a_f.x, m.a_b.x), scatter_back_energy(m.a_f.y, m.a_b.y), scatter_back_energy(m.a_f.z, m.a_b.z));
  Float a_f = scatter_mean_channel(m.a_f);
  Float a_b = scatter_mean_channel(m.a_b);
  Float f2 = a_f * a_f;
  Float b2 = a_b * a_b;
  Float k = Float(1.0f) / max(Float(1.0f) - f2, Float(1.0e-4f));
  Float shift =
      m.shift_b * (Float(1.0f) - Float(2.0f) * b2 * k * k) + m.shift_f * (Float(2.0f) * k + Float(4.0f) * f2 * b2 * k * k * k);
  // The formula is Zinke's, for deviations of theta_h: half of those of theta_i + theta_o.
  Float one = sqrt(Float(2.0f) * m.v_f + m.v_b);
  Float three = sqrt(Float(2.0f) * m.v_f + Float(3.0f) * m.v_b);
  Float sigma = (Float(1.0f) + Float(kDualDensity) * f2) * (one + b2 * three) /
                (Float(1.0f) + b2 * (sqrt(m.v_f) + Float(1.5f) * sqrt(m.v_b)));
  shift = v_clamp(shift, -Float(kHalfPi), Float(kHalfPi));
  b.cone = scatter_cone(sin_o, cos_o, shift, sigma * sigma);
  return b;
}

// Share of light that meets no hair where n hairs lie in its way on average (Poisson).
PELAGE_FN Float scatter_dual_direct(Float n) { return m_exp(-n); }

// Of light that comes through hairs, the share `kept` with and `direct` without scattering on the way: what was scattered.
PELAGE_FN Vec3 scatter_dual_scattered(Vec3 kept, Float direct) { return (kept - v_splat(direct)) * Float(kDualDensity); }
// Share of light that comes through n hairs on average after at least one forward scattering: d_f times the mean of
// a_f^k over Poisson-distributed k >= 1. Zinke's product of a_f over exactly n hairs, without its step at n = 1.
PELAGE_FN Vec3 scatter_dual_transmittance(Float n, Vec3 a_f) {
  return scatter_dual_scattered(v_exp((a_f - v_splat(Float(1.0f))) * n), m_exp(-n));
}

// Variance that n hairs add to the light that comes through: n >= 1 of them took part. Zinke 2008, section 3.1.
PELAGE_FN Float scatter_dual_variance(Float n, Float v_f) { return max(n, Float(1.0f)) * v_f; }

// A cone widened by the variance that the light brings along.
PELAGE_FN ScatterCone scatter_cone_widened(ScatterCone c, Float v) { return scatter_cone_with_variance(c, c.v + v); }

// Sharpness of a pair's half circle: the logistic's slope at the edge equals the blurred pair's.
PELAGE_FN Float scatter_pair_sharpness(ScatterPair n) {
  Float kappa = n.kappa / (Float(1.0f) + Float(2.0f) * n.kappa * (Float(1.0f) - n.cos_mu));
  return min(Float(1.27323954f) * kappa, Float(1.59576912f) * sqrt(kappa));
}

// N_R averaged over the half circle of azimuths that scattered light comes from: uniform, plus the first harmonic (1/3 of
// cos(phi/2)/4, times 2/pi of the half circle). Integral over phi: 1.
PELAGE_FN Float scatter_reflection_averaged(Float cos_phi) {
  return Float(kInvTwoPi) * (Float(1.0f) + Float(0.424413182f) * cos_phi);
}

// f_F cos(theta_i): this fiber scatters light that other fibers scattered forward. Huang 2025, eq. 2
// (references.bib: Huang2025LevelOfDetail).
PELAGE_FN Vec3 scatter_dual_forward_marschner(ScatterLobes l, Float v, Float sin_i, Float cos_i, Float cos_phi) {
  Float r = scatter_cone_value(scatter_cone_widened(l.r, v), sin_i, cos_i) * l.a_r * scatter_reflection_averaged(cos_phi);
  Float tt = scatter_cone_value(scatter_cone_widened(l.tt, v), sin_i, cos_i) *
             scatter_half_circle(-scatter_pair_sharpness(l.n_tt), cos_phi);
  Float m_trt = scatter_cone_value(scatter_cone_widened(l.trt, v), sin_i, cos_i);
  Float trt = m_trt * scatter_half_circle(scatter_pair_sharpness(l.n_trt), cos_phi);
  return v_splat(r) + l.a_tt * tt + l.a_trt * trt + l.a_rest * (m_trt * Float(kInvTwoPi));
}
PELAGE_FN Vec3 scatter_dual_forward_zhu(ScatterLobes l, Float v, Float sin_i, Float cos_i, Float cos_phi) {
  Float r = scatter_cone_value(scatter_cone_widened(l.r, v), sin_i, cos_i) * l.a_r * Float(kInvTwoPi);
  Float tt = scatter_cone_value(scatter_cone_widened(l.tt, v), sin_i, cos_i) *
             scatter_half_circle(-scatter_pair_sharpness(l.n_tt), cos_phi);
  return v_splat(r) + l.a_tt * tt + l.a_rest * scatter_diffuse(cos_i);
}
// A fringe has the curvature of a von Mises lobe of kappa = 5/width^2 where it is narrow, and its first harmonic,
// kappa = 4/width, where it is wide.
PELAGE_FN Float scatter_fringe_sharpness(ScatterFringe n) {
  Float inv = n.width * n.width / (Float(5.0f) + Float(4.0f) * n.width) + Float(2.0f) * (Float(1.0f) - n.cos_mu);
  Float kappa = Float(1.0f) / inv;
  return min(Float(1.27323954f) * kappa, Float(1.59576912f) * sqrt(kappa));
}
PELAGE_FN Vec3 scatter_dual_forward_pelekis(ScatterPelekis l, Float v, Float sin_i, Float cos_phi) {
  Float r = scatter_band_value(scatter_band_widened(l.r, v), sin_i) * l.a_r * scatter_reflection_averaged(cos_phi);
  Float tt = scatter_band_value(scatter_band_widened(l.tt, v), sin_i) *
             scatter_half_circle(-scatter_fringe_sharpness(l.n_tt), cos_phi);
  Float m_trt = scatter_band_value(scatter_band_widened(l.trt, v), sin_i);
  Float trt = m_trt * scatter_half_circle(scatter_fringe_sharpness(l.n_trt), cos_phi);
  return v_splat(r) + l.a_tt * tt + l.a_trt * trt + l.a_rest * (m_trt * Float(kInvTwoPi));
}

PELAGE_FN Vec3 scatter_dual_forward_sadeghi(ScatterArtist l, Float v, Float sin_i, Float cos_i, Float cos_phi) {
  Float around = scatter_reflection_averaged(cos_phi);
  Float r = scatter_cone_value(scatter_cone_widened(l.r, v), sin_i, cos_i) * around;
  Float tt = scatter_cone_value(scatter_cone_widened(l.tt, v), sin_i, cos_i) *
             scatter_half_circle(-scatter_pair_sharpness(l.n_tt), cos_phi);
  Float m_trt = scatter_cone_value(scatter_cone_widened(l.trt, v), sin_i, cos_i);
  Float glint = scatter_half_circle(scatter_pair_sharpness(l.n_glint), cos_phi);
  return l.a_r * r + l.a_tt * tt + (l.a_trt * around + l.a_glint * glint) * m_trt;
}

// d_b f_B cos(theta_i): light that the hairs around and behind send back, on the lit half circle (soft edge).
// v: variance that the light brings along, 0 for direct light. Integral over the sphere: 2 d_b A_B.
// Zinke 2008, eq. 9, 10 and 15; Huang 2025, eq. 3 leaves the 2 out (docs/derivations/dual_scattering.md tells why we do not).
PELAGE_FN Vec3 scatter_dual_local(ScatterBack b, Float v, Float sin_i, Float cos_i, Float cos_phi) {
  Float m = scatter_cone_value(scatter_cone_widened(b.cone, v), sin_i, cos_i);
  return b.a * (Float(2.0f * kDualDensity) * m * scatter_half_circle(Float(kBackEdgeSharpness), cos_phi));
}
