// A bundle of fibers as one thick hair: Huang 2025, section 4 (references.bib: Huang2025LevelOfDetail), and what we do instead where
// traced bundles say otherwise.
//   ScatterAggregate a = scatter_prepare_aggregate(l, b)                      per shading point; l of one fiber, b of bundle.h
//   ScatterShares s = scatter_shares(a, cos_phi)                               per light
//   Vec3 v = scatter_aggregate_marschner(a, s, sin_i, cos_i, cos_phi)            f cos(theta_i)
// With scatter_prepare_huang and scatter_shares_huang it is the paper's model; scatter_aggregate_zhu_2023 is the one before that.
// f is that of the hairs which the eye sees: its mean over the rays that meet any hair. The share of rays that do is
// scatter_bundle_coverage; what lies behind shows through the rest. Conventions are those of fiber.h.
// Derivations, and the errors of all of them against traced bundles: docs/derivations/aggregated_scattering.md.

// Energy that the backward lobe leaves out, of what the closure gives it: covers the closure's own error, which grows with how flat
// the ellipse is, so that white hair makes no light.
const float kAggregateReserve = 0.06f;
const float kAggregateFlatReserve = 0.15f;

// Energies by lobe and channel.
struct ScatterEnergies {
  Vec3 r;
  Vec3 tt;
  Vec3 trt;
  Vec3 rest;
};

struct ScatterAggregate {
  ScatterLobes near;     // of the hair that is seen, under light that met no other
  ScatterLobes through;  // under light that others sent on: cones and pairs wider by what those added, eq. 9
  Vec3 a_f;              // mean forward attenuation of a hair
  Vec3 a_back;           // A_B
  ScatterCone back;      // M_B
  ScatterBundle bundle;
  Float back_norm;        // 1 over the integral of N_B's shape
  ScatterEnergies first;  // of `near` and of `through` by lobes, as they come through the bundle; for sampling
  ScatterEnergies straight;
};

// How much of the light comes by each set of lobes, and N_B.
struct ScatterShares {
  Vec3 near;
  Vec3 through;
  Float back;
  Vec3 shade;  // of the backward lobe
};

PELAGE_FN ScatterEnergies scatter_energies_of(ScatterLobes l) {
  ScatterEnergies e;
  e.r = v_splat(l.a_r);
  e.tt = l.a_tt;
  e.trt = l.a_trt;
  e.rest = l.a_rest;
  return e;
}

// ---- What several hairs do to a lobe ----------------------------------------------------------------------------------------

// A pair blurred by another variance v: variances of independent turns add, and 1/kappa is one.
PELAGE_FN ScatterPair scatter_pair_blurred(ScatterPair n0, Float v) {
  ScatterPair n = n0;
  n.kappa = n0.kappa / (Float(1.0f) + n0.kappa * v);
  n.norm = Float(0.0795774715459477f) / scatter_i0e(n.kappa);
  return n;
}
// Mean variance around the fiber, from phi = pi, of what one hair sends forward: TT by its own, the rest by the half circle's.
PELAGE_FN Float scatter_forward_blur(ScatterLobes l, Vec3 a_f) {
  Float tt = scatter_mean_channel(l.a_tt) * l.front_tt;
  Float other = max(scatter_mean_channel(a_f) - tt, Float(0.0f));
  Float v_tt = Float(1.0f) / max(l.n_tt.kappa, Float(1.0e-2f)) + Float(2.0f) * (Float(1.0f) - l.n_tt.cos_mu);
  return (tt * v_tt + other * Float(0.822467033f)) / max(tt + other, Float(1.0e-30f));
}
// A lobe's cone after `before` other hairs, which sent light on with the mean variance and shift of m.
PELAGE_FN ScatterCone scatter_cone_after(ScatterLobes l, ScatterCone c, ScatterAverages m, Float before) {
  Float shift = v_clamp(c.shift + before * m.shift_f, -Float(kHalfPi), Float(kHalfPi));
  return scatter_cone(l.sin_o, l.cos_o, shift, c.v + before * m.v_f);
}
// Eq. 9: all lobes after `before` other hairs. The paper's betas are variances there; around the fiber we add the variance that
// hairs have around the fiber.
PELAGE_FN ScatterLobes scatter_lobes_after(ScatterLobes l, ScatterAverages m, Float before) {
  Float around = before * scatter_forward_blur(l, m.a_f);
  ScatterLobes t = l;
  t.r = scatter_cone_after(l, l.r, m, before);
  t.tt = scatter_cone_after(l, l.tt, m, before);
  t.trt = scatter_cone_after(l, l.trt, m, before);
  t.n_tt = scatter_pair_blurred(l.n_tt, around);
  t.n_trt = scatter_pair_blurred(l.n_trt, around);
  return t;
}

// ---- The paper's model ------------------------------------------------------------------------------------------------------

// What the paper fixes by hand, and what can be switched off.
struct ScatterAggregateTerms {
  Float forward;  // d_F: on light that other hairs sent on
  Float back;     // d_B: on A_1 and A_3
  Float side;     // d_1+: on A_1+, eq. 10; 0 leaves it out
  Float masked;   // c_m, eq. 13
  Float shadow;   // 1: with S, eq. 15; 0: without
};
PELAGE_FN ScatterAggregateTerms scatter_terms_huang() {
  ScatterAggregateTerms t;
  t.forward = Float(1.0f);
  t.back = Float(1.0f);
  t.side = Float(0.6f);
  t.masked = Float(0.2f);
  t.shadow = Float(1.0f);
  return t;
}

// The same with constants fitted to traced bundles (with the paper's n; docs/derivations/aggregated_scattering.md).
PELAGE_FN ScatterAggregateTerms scatter_terms_fitted() {
  ScatterAggregateTerms t;
  t.forward = Float(0.58f);
  t.back = Float(0.61f);
  t.side = Float(0.12f);
  t.masked = Float(0.17f);
  t.shadow = Float(1.0f);
  return t;
}

// Energies of the backward paths of one channel.
struct ScatterBackPaths {
  Float one;    // A_1, F^i B F^i: Zinke 2008, eq. 11
  Float side;   // A_1+, F^(i+1) B F^i: Huang 2025, eq. 10
  Float three;  // A_3, three backward events: Zinke 2008, eq. 13
};
PELAGE_FN ScatterBackPaths scatter_back_paths(Float a_f, Float a_b, Float n, ScatterAggregateTerms t) {
  Float x = min(a_f * a_f, Float(0.9999f));
  Float k = Float(1.0f) / (Float(1.0f) - x);
  ScatterBackPaths p;
  p.one = t.back * a_b * x * k;
  p.three = p.one * (a_b * k) * (a_b * k);
  p.side = t.side * a_b * a_f * k * (Float(1.0f) - m_pow(x, max(n, Float(1.0f))));  // the sum of a_F^(2i-1) over i = 1...n
  return p;
}
PELAGE_FN Float scatter_back_sum(ScatterBackPaths p) { return p.one + p.side + p.three; }

// M_B of eq. 11: the variances of all paths, weighted with their energies. Forward events of the sums: 2/(1 - a_F^2) of A_1, one
// less of A_1+, 2 (1 + 2 a_F^2)/(1 - a_F^2) of A_3. Shifts as in dual scattering.
PELAGE_FN ScatterCone scatter_back_cone(ScatterLobes l, ScatterAverages m, ScatterBackPaths p) {
  Float f = scatter_mean_channel(m.a_f);
  Float x = min(f * f, Float(0.9999f));
  Float k = Float(1.0f) / (Float(1.0f) - x);
  Float one = Float(2.0f) * k * m.v_f + m.v_b;
  Float side = (Float(1.0f) + x) * k * m.v_f + m.v_b;
  Float three = Float(2.0f) * (Float(1.0f) + Float(2.0f) * x) * k * m.v_f + Float(3.0f) * m.v_b;
  Float v = (p.one * one + p.side * side + p.three * three) / max(scatter_back_sum(p), Float(1.0e-30f));
  Float shift = v_clamp(m.shift_b + Float(2.0f) * k * m.shift_f, -Float(kHalfPi), Float(kHalfPi));
  return scatter_cone(l.sin_o, l.cos_o, shift, max(v, Float(1.0e-6f)));
}

// Energies that leave on the lit half circle, as the lobes' averaged shapes have them: rather too much of TT.
PELAGE_FN Vec3 scatter_lit_energy(ScatterLobes l) {
  Float tt = Float(1.0f) / (Float(1.0f) + m_exp(scatter_pair_sharpness(l.n_tt)));
  Float trt = Float(1.0f) - Float(1.0f) / (Float(1.0f) + m_exp(scatter_pair_sharpness(l.n_trt)));
  // R over the half circle: 1/2 where it is even, sin(pi/4) where it falls as cos(phi/2); front_r tells which.
  Float r = Float(0.5f) + Float(1.516f) * (Float(0.5f) - l.front_r);
  return v_splat(l.a_r * r) + l.a_tt * tt + l.a_trt * trt + l.a_rest * Float(0.5f);
}
PELAGE_FN Vec3 scatter_total_energy(ScatterLobes l) { return v_splat(l.a_r) + l.a_tt + l.a_trt + l.a_rest; }

// What the backward lobe may have without making light: the rest of one channel's energy.
PELAGE_FN Float scatter_back_limited(Float back, Float lit, Float total, Float passed) {
  Float direct = lit + (total - lit) * passed;
  return min(back, max(Float(1.0f - kAggregateReserve) - direct, Float(0.0f)));
}
// Eq. 7: what the n - 1 hairs before the last one leave of the light.
PELAGE_FN Float scatter_passed_huang(Float n, Float a_f) { return m_pow(a_f, max(n, Float(1.0f)) - Float(1.0f)); }

// Eq. 7 to 11. A_B is cut where the paper's sums would make light, which they do in white hair.
PELAGE_FN ScatterAggregate scatter_prepare_huang(ScatterLobes l, ScatterBundle b, ScatterAggregateTerms t) {
  ScatterAggregate a;
  ScatterAverages m = scatter_averages(l);
  Float n = scatter_bundle_crossings(b, Float(-1.0f));
  Float fewest = min(n, scatter_bundle_crossings(b, Float(0.0f)));
  a.near = l;
  a.through = scatter_lobes_after(l, m, max(n, Float(1.0f)) - Float(1.0f));
  a.a_f = m.a_f;
  a.bundle = b;
  a.back_norm = Float(0.0f);
  Vec3 lit = scatter_lit_energy(l);
  Vec3 all = scatter_total_energy(l);
  Float x = scatter_back_sum(scatter_back_paths(m.a_f.x, m.a_b.x, n, t));
  Float y = scatter_back_sum(scatter_back_paths(m.a_f.y, m.a_b.y, n, t));
  Float z = scatter_back_sum(scatter_back_paths(m.a_f.z, m.a_b.z, n, t));
  a.a_back = Vec3(scatter_back_limited(x, lit.x, all.x, scatter_passed_huang(fewest, m.a_f.x)),
                  scatter_back_limited(y, lit.y, all.y, scatter_passed_huang(fewest, m.a_f.y)),
                  scatter_back_limited(z, lit.z, all.z, scatter_passed_huang(fewest, m.a_f.z)));
  a.back = scatter_back_cone(l, m, scatter_back_paths(scatter_mean_channel(m.a_f), scatter_mean_channel(m.a_b), n, t));
  a.first = scatter_energies_of(l);
  a.straight = scatter_energies_of(l);
  return a;
}

// Eq. 12 to 14: probabilities that one hair, or none, stands between the light and what is seen; the rest is dark. P_n of
// eq. 14 is negative for rho < 1/6 near phi = 90 degrees: it is cut off there and the three are scaled to the sum 1.
PELAGE_FN Vec2 scatter_shadow_chances(Float density, Float masked, Float cos_phi) {
  Float open = Float(1.0f) - density;
  Float single = open * (Float(1.0f) - v_clamp(cos_phi, Float(0.0f), Float(1.0f)));
  Float many = open * masked;
  Float none = max(Float(1.0f) - single - many, Float(0.0f));
  Float inv = Float(1.0f) / (single + many + none);
  return Vec2(single * inv, none * inv);
}
// S of the lit half circle, eq. 15.
PELAGE_FN Vec3 scatter_shadow(Float density, Float masked, Float cos_phi, Vec3 a_f) {
  Vec2 p = scatter_shadow_chances(density, masked, cos_phi);
  return a_f * p.x + v_splat(p.y);
}

// Eq. 6: on the lit half circle n = 1, on the other the hairs before the last one take their part. The edge between both is soft,
// as in dual.h.
PELAGE_FN ScatterShares scatter_shares_huang(ScatterAggregate a, ScatterAggregateTerms t, Float cos_phi) {
  Float lit_side = scatter_half_circle(Float(kBackEdgeSharpness), cos_phi);
  Float lit = Float(kPi) * lit_side;
  Float n = scatter_bundle_crossings(a.bundle, cos_phi);
  Vec3 passed = Vec3(scatter_passed_huang(n, a.a_f.x), scatter_passed_huang(n, a.a_f.y), scatter_passed_huang(n, a.a_f.z));
  Vec3 shadow = scatter_shadow(a.bundle.density, t.masked, cos_phi, a.a_f);
  ScatterShares s;
  s.shade = v_splat(Float(1.0f)) + (shadow - v_splat(Float(1.0f))) * (lit * t.shadow);
  s.near = s.shade * lit;
  s.through = passed * ((Float(1.0f) - lit) * t.forward);
  s.back = lit_side;
  return s;
}

// ---- Ours -------------------------------------------------------------------------------------------------------------------
// The hair that the eye sees is lit directly where nothing is in the way, and through others, by how many is a matter of chance:
// scatter_bundle_visible has both. What then still is on its way is spread evenly.

// An even function of phi as a sum of cosines of 0, 1, ... 4 times phi, and such means of a lobe.
struct ScatterSeries {
  Float c0;
  Float c1;
  Float c2;
  Float c3;
  Float c4;
};
PELAGE_FN Float scatter_series_over(ScatterSeries v, ScatterSeries means) {
  return v.c0 + v.c1 * means.c1 + v.c2 * means.c2 + v.c3 * means.c3 + v.c4 * means.c4;
}
PELAGE_FN ScatterSeries scatter_series_minus(ScatterSeries a, ScatterSeries b) {
  ScatterSeries s;
  s.c0 = a.c0 - b.c0;
  s.c1 = a.c1 - b.c1;
  s.c2 = a.c2 - b.c2;
  s.c3 = a.c3 - b.c3;
  s.c4 = a.c4 - b.c4;
  return s;
}
// Means over a pair around phi = 0: powers of the mean resultant length, as of a wrapped normal distribution. I1/I0: Amos 1974
// (references.bib: Amos1974Bessel).
PELAGE_FN ScatterSeries scatter_pair_means(ScatterPair n) {
  Float k = n.kappa;
  Float one = k / (Float(0.5f) + sqrt(k * k + Float(2.25f)));
  Float four = v_square(v_square(one));
  Float cosine = n.cos_mu;
  Float twice = Float(2.0f) * cosine * cosine - Float(1.0f);
  ScatterSeries m;
  m.c0 = Float(1.0f);
  m.c1 = one * cosine;
  m.c2 = four * twice;
  m.c3 = four * four * one * cosine * (Float(2.0f) * twice - Float(1.0f));
  m.c4 = v_square(four * four) * (Float(2.0f) * twice * twice - Float(1.0f));
  return m;
}
// The functions of phi of three channels, as means over one lobe.
struct ScatterSeries3 {
  ScatterSeries x;
  ScatterSeries y;
  ScatterSeries z;
};
PELAGE_FN Vec3 scatter_series3_over(ScatterSeries3 v, ScatterSeries means) {
  return Vec3(scatter_series_over(v.x, means), scatter_series_over(v.y, means), scatter_series_over(v.z, means));
}
// Energies of all lobes under such functions.
PELAGE_FN ScatterEnergies scatter_energies_under(ScatterLobes l, ScatterSeries3 v) {
  // R is even, or falls as cos(phi/2): front_r tells which.
  Float falls = Float(7.32f) * (Float(0.5f) - l.front_r);
  ScatterSeries r;
  r.c0 = Float(1.0f);
  r.c1 = falls * Float(0.333333333f);
  r.c2 = falls * Float(-0.0666666667f);
  r.c3 = falls * Float(0.0285714286f);
  r.c4 = falls * Float(-0.0158730159f);
  ScatterSeries behind = scatter_pair_means(l.n_tt);
  behind.c1 = -behind.c1;
  behind.c3 = -behind.c3;
  ScatterEnergies e;
  e.r = v_positive(scatter_series3_over(v, r)) * l.a_r;
  e.tt = v_positive(scatter_series3_over(v, behind)) * l.a_tt;
  e.trt = v_positive(scatter_series3_over(v, scatter_pair_means(l.n_trt))) * l.a_trt;
  e.rest = Vec3(v.x.c0, v.y.c0, v.z.c0) * l.a_rest;
  return e;
}
PELAGE_FN Vec3 scatter_energies_sum(ScatterEnergies e) { return e.r + e.tt + e.trt + e.rest; }
// scatter_bundle_visible at 0, 45, ... 180 degrees as a series; at 0 without the peak that is there alone.
PELAGE_FN ScatterSeries scatter_visible_around(ScatterBundle b, Float loss) {
  ScatterWay ahead = scatter_bundle_way(b, Float(1.0f));
  ScatterWay slanted = scatter_bundle_way(b, Float(0.707106781f));
  ahead.joint = slanted.joint;
  Float v0 = scatter_bundle_visible(b, ahead, loss);
  Float v1 = scatter_bundle_visible(b, slanted, loss);
  Float v2 = scatter_bundle_visible(b, scatter_bundle_way(b, Float(0.0f)), loss);
  Float v3 = scatter_bundle_visible(b, scatter_bundle_way(b, Float(-0.707106781f)), loss);
  Float v4 = scatter_bundle_visible(b, scatter_bundle_way(b, Float(-1.0f)), loss);
  ScatterSeries s;
  s.c0 = Float(0.125f) * (v0 + v4) + Float(0.25f) * (v1 + v2 + v3);
  s.c1 = Float(0.25f) * (v0 - v4) + Float(0.353553391f) * (v1 - v3);
  s.c2 = Float(0.25f) * (v0 + v4) - Float(0.5f) * v2;
  s.c3 = Float(0.25f) * (v0 - v4) - Float(0.353553391f) * (v1 - v3);
  s.c4 = Float(0.125f) * (v0 + v4) - Float(0.25f) * (v1 - v2 + v3);
  return s;
}

// Energy of one channel of what leaves neither at once nor straight on. Light that met a first hair leaves with `first`; the rest
// meets others, of which each keeps `albedo` and lets the share `escape` of that out: a geometric sum, without what `straight`
// already has of it. White hair (albedo 1) gives all of the light back.
PELAGE_FN Float scatter_left_over(Float albedo, Float first, Float straight, Float escape, Float kept) {
  Float a = min(albedo, Float(1.0f));
  Float later = max(a - first, Float(0.0f)) * a * escape / max(Float(1.0f) - a * (Float(1.0f) - escape), Float(1.0e-6f));
  return max(later * kept - straight, Float(0.0f));
}

// Mean number of hairs that sent light on before the one that is seen, of the light that comes through: s G'(s)/(G(s) - G(0))
// where G(s) is the mean of s^k over the numbers k of hairs on the way.
PELAGE_FN Float scatter_hairs_before(ScatterBundle b, Float a_f) {
  ScatterWay w = scatter_bundle_way(b, Float(-1.0f));
  Float here = scatter_bundle_visible(b, w, Float(1.0f) - a_f);
  Float less = scatter_bundle_visible(b, w, Float(1.0f) - Float(0.9f) * a_f);
  Float none = scatter_bundle_visible(b, w, Float(1.0f));
  return v_clamp(Float(10.0f) * (here - less) / max(here - none, Float(1.0e-6f)), Float(1.0f), Float(64.0f));
}

PELAGE_FN ScatterAggregate scatter_prepare_aggregate(ScatterLobes l, ScatterBundle b) {
  ScatterAggregate a;
  ScatterAverages m = scatter_averages(l);
  a.near = l;
  a.through =
      scatter_lobes_after(l, m, scatter_hairs_before(b, v_clamp(scatter_mean_channel(m.a_f), Float(0.05f), Float(1.0f))));
  a.a_f = m.a_f;
  a.bundle = b;
  Float mean_axis = Float(0.5f) * (b.wide + sqrt(b.deep2));
  Float oblong = (b.wide2 + b.deep2) / (Float(2.0f) * mean_axis * mean_axis) - Float(1.0f);  // ((a - b)/(a + b))^2
  a.back_norm = Float(kInvTwoPi) /
                (mean_axis * (Float(1.0f) + Float(3.0f) * oblong / (Float(10.0f) + sqrt(Float(4.0f) - Float(3.0f) * oblong))));
  ScatterSeries3 none;
  none.x = scatter_visible_around(b, Float(1.0f));
  none.y = none.x;
  none.z = none.x;
  ScatterSeries3 some;
  some.x = scatter_series_minus(scatter_visible_around(b, Float(1.0f) - m.a_f.x), none.x);
  some.y = scatter_series_minus(scatter_visible_around(b, Float(1.0f) - m.a_f.y), none.y);
  some.z = scatter_series_minus(scatter_visible_around(b, Float(1.0f) - m.a_f.z), none.z);
  a.first = scatter_energies_under(l, none);
  a.straight = scatter_energies_under(a.through, some);
  Vec3 first = scatter_energies_sum(a.first);
  Vec3 straight = scatter_energies_sum(a.straight);
  Vec3 all = scatter_total_energy(l);
  Float escape = scatter_bundle_escape(b);
  Float kept = Float(1.0f - kAggregateReserve) - Float(kAggregateFlatReserve) * oblong;
  a.a_back = Vec3(scatter_left_over(all.x, first.x, straight.x, escape, kept),
                  scatter_left_over(all.y, first.y, straight.y, escape, kept),
                  scatter_left_over(all.z, first.z, straight.z, escape, kept));
  // Its cone: the mean hair's, as often as light meets one.
  Float f = scatter_mean_channel(m.a_f);
  Float back = scatter_mean_channel(m.a_b);
  Float albedo = min(f + back, Float(1.0f));
  Float inv = Float(1.0f) / max(f + back, Float(1.0e-30f));
  Float one = (f * m.v_f + back * m.v_b) * inv;
  Float shift = (f * m.shift_f + back * m.shift_b) * inv;
  Float events =
      Float(2.0f) + albedo * (Float(1.0f) - escape) / max(Float(1.0f) - albedo * (Float(1.0f) - escape), Float(1.0e-2f));
  shift = v_clamp(shift * events, -Float(kHalfPi), Float(kHalfPi));
  a.back = scatter_cone(l.sin_o, l.cos_o, shift, one * events);
  return a;
}

PELAGE_FN ScatterShares scatter_shares(ScatterAggregate a, Float cos_phi) {
  ScatterWay w = scatter_bundle_way(a.bundle, cos_phi);
  Float direct = scatter_bundle_visible(a.bundle, w, Float(1.0f));
  Vec3 all = Vec3(scatter_bundle_visible(a.bundle, w, Float(1.0f) - a.a_f.x),
                  scatter_bundle_visible(a.bundle, w, Float(1.0f) - a.a_f.y),
                  scatter_bundle_visible(a.bundle, w, Float(1.0f) - a.a_f.z));
  ScatterShares s;
  s.near = v_splat(direct);
  s.through = v_positive(all - s.near);
  // Dense bundles send toward each side in proportion to the width that they have there.
  Float cos2 = cos_phi * cos_phi;
  s.back = a.back_norm * sqrt(a.bundle.wide2 * cos2 + a.bundle.deep2 * max(Float(1.0f) - cos2, Float(0.0f)));
  s.shade = v_splat(Float(1.0f));
  return s;
}

// ---- The value --------------------------------------------------------------------------------------------------------------

// Of all, from f cos(theta_i) of both sets of lobes.
PELAGE_FN Vec3 scatter_aggregate_sum(ScatterAggregate a, ScatterShares s, Vec3 near, Vec3 through, Float sin_i, Float cos_i) {
  return near * s.near + through * s.through + a.a_back * s.shade * (s.back * scatter_cone_value(a.back, sin_i, cos_i));
}
PELAGE_FN Vec3 scatter_aggregate_marschner(ScatterAggregate a, ScatterShares s, Float sin_i, Float cos_i, Float cos_phi) {
  return scatter_aggregate_sum(a, s, scatter_marschner(a.near, sin_i, cos_i, cos_phi),
                               scatter_marschner(a.through, sin_i, cos_i, cos_phi), sin_i, cos_i);
}
PELAGE_FN Vec3 scatter_aggregate_zhu(ScatterAggregate a, ScatterShares s, Float sin_i, Float cos_i, Float cos_phi) {
  return scatter_aggregate_sum(a, s, scatter_zhu(a.near, sin_i, cos_i, cos_phi), scatter_zhu(a.through, sin_i, cos_i, cos_phi),
                               sin_i, cos_i);
}

// ---- Zhu 2023 ---------------------------------------------------------------------------------------------------------------

// R/D/F/B as Huang 2025 tells them in section 3.3, eq. 4 and 5: `kept` is f cos(theta_i) of the fiber without TT, in full; F has
// a_F^n of the light, B Zinke's A_1 + A_3 of endless hair. The azimuth of F is told in words only: even over the front half
// circle as in dual scattering, or (narrow = 1) around phi = pi with the variance that n hairs add.
PELAGE_FN Vec3 scatter_aggregate_zhu_2023(ScatterLobes l, ScatterBundle b, Float narrow, Vec3 kept, Float sin_i, Float cos_i,
                                          Float cos_phi) {
  ScatterAverages m = scatter_averages(l);
  ScatterBack local = scatter_back(m, l.sin_o, l.cos_o);
  Float n = max(scatter_bundle_crossings(b, Float(-1.0f)), Float(1.0f));
  ScatterPair pair = scatter_pair_blurred(l.n_tt, (n - Float(1.0f)) * scatter_forward_blur(l, m.a_f));
  Float around = select(narrow > Float(0.5f), scatter_pair_value(pair, -cos_phi, scatter_sin_phi(cos_phi), Float(0.0f)),
                        scatter_half_circle(-Float(kBackEdgeSharpness), cos_phi));
  Float forward = around * scatter_cone_value(scatter_cone(l.sin_o, l.cos_o, m.shift_f, n * m.v_f), sin_i, cos_i);
  Float back = scatter_half_circle(Float(kBackEdgeSharpness), cos_phi) * scatter_cone_value(local.cone, sin_i, cos_i);
  Vec3 a_forward = Vec3(m_pow(m.a_f.x, n), m_pow(m.a_f.y, n), m_pow(m.a_f.z, n));
  return kept + a_forward * forward + local.a * back;
}
