// A fiber's lobes under a prefiltered environment: what goes back toward the eye's side, R and TRT, as one GGX lobe, what
// comes through, TT, as another (Lipp 2026, section 3.4; references.bib: Lipp2026Deferred, has the first alone).
// Derivation and what it leaves: docs/derivations/probe.md. Directions in the plane of the strand and the eye:
// (across, along), across toward the eye in the normal plane, along from root to tip.

// Of what a fiber scatters under a half-bright sky, over its mean; RMS over directions of strand and eye. The worst is smooth
// black hair at a slant, whose lobes are sharper than the sharpest map.
const float kGlowMaxRelError = 0.25f;
const float kGlowCosineMean = 0.666666667f;  // mean cosine of the widest lobe, alpha = 1
// alpha = x (k0 + k1 x + k2 x^2), x = 1 - mean cosine: fitted by tools/fit_probe.py, relative error at most 0.047.
const float kGlowAlpha0 = 2.5159f;
const float kGlowAlpha1 = -8.7671f;
const float kGlowAlpha2 = 29.91f;
// Of N_R over A_R (pelekis.h) the share with |phi| < pi/2, and integrals of cos(phi) over that half and over all.
const float kGlowEvenFront = 0.707106781f;
const float kGlowEvenFrontCos = 0.471404521f;
const float kGlowEvenCos = 0.333333333f;
const float kGlowShoulderFront = 0.176776695f;
const float kGlowShoulderFrontCos = 0.050507627f;
const float kGlowShoulderCos = -0.428571429f;
const float kGlowRimFront = 0.002762136f;
const float kGlowRimFrontCos = 0.000290751f;
const float kGlowRimCos = -0.789473684f;

struct ScatterGlow {
  Vec3 energy;
  Vec2 axis;    // unit length
  Float alpha;  // roughness
  Float even;   // share of the energy that no lobe about the axis can place: comes from everywhere
};

// Mean of (cos(theta_i), sin(theta_i)) over a band: exact along the fiber where M is a von Mises-Fisher lobe seen from its
// side; across it between its limits, a narrow lobe, a lobe at the fiber's end, and an even one.
PELAGE_FN Vec2 scatter_band_mean(ScatterBand b) {
  Float v = min(b.v, Float(16.0f));
  Float e = m_exp(Float(-2.0f) / v);
  Float size = max((Float(1.0f) + e) / (Float(1.0f) - e) - v, Float(0.0f));
  Float c2 = b.cosine * b.cosine;
  Float spread = Float(0.617f) + size * (Float(0.383f) + Float(0.571f) * (Float(1.0f) - c2));
  return Vec2(sqrt(size * size * c2 + (Float(1.0f) - size) * spread), -(size * b.sine));
}
// Mean cosine of azimuth about a pair's center: from the integrals of consecutive powers.
PELAGE_FN Float scatter_fringe_mean(ScatterFringe n) {
  Float z2 = n.z * n.z;
  Float p2 = Float(1.5f) * z2 - Float(0.5f);
  Float p3 = n.z * (Float(2.5f) * z2 - Float(1.5f));
  return (n.z - p2 / p3) / n.b * n.cos_mu;
}

// One lobe of what has the mean direction `mean`, of length 0 to 1. Beyond the widest lobe the axis keeps a share that has
// the same mean.
PELAGE_FN ScatterGlow scatter_glow(Vec3 energy, Vec2 mean) {
  Float size = sqrt(dot(mean, mean));
  Float inv = Float(1.0f) / max(size, Float(1.0e-6f));
  Float x = Float(1.0f) - v_clamp(size, Float(kGlowCosineMean), Float(1.0f));
  Mask none = size < Float(1.0e-6f);
  ScatterGlow g;
  g.energy = energy;
  g.axis = Vec2(select(none, Float(1.0f), mean.x * inv), select(none, Float(0.0f), mean.y * inv));
  g.alpha = min(x * (Float(kGlowAlpha0) + x * (Float(kGlowAlpha1) + x * Float(kGlowAlpha2))), Float(1.0f));
  g.even = max(Float(1.0f) - size / Float(kGlowCosineMean), Float(0.0f));
  return g;
}

struct ScatterGlows {
  ScatterGlow front;  // R on the eye's side, TRT
  ScatterGlow back;   // TT, R on the other side
};
PELAGE_FN ScatterGlows scatter_glows(ScatterPelekis l) {
  Float even = Float(1.0f) - l.shoulder - l.rim;
  Float front = even * Float(kGlowEvenFront) + l.shoulder * Float(kGlowShoulderFront) + l.rim * Float(kGlowRimFront);
  Float front_cos =
      even * Float(kGlowEvenFrontCos) + l.shoulder * Float(kGlowShoulderFrontCos) + l.rim * Float(kGlowRimFrontCos);
  Float all_cos = even * Float(kGlowEvenCos) + l.shoulder * Float(kGlowShoulderCos) + l.rim * Float(kGlowRimCos);
  Vec2 r = scatter_band_mean(l.r);
  Vec2 tt = scatter_band_mean(l.tt);
  Vec2 trt = scatter_band_mean(l.trt);
  Float y_tt = v_luminance(l.a_tt);
  Float y_trt = v_luminance(l.a_trt);
  Float r_f = l.a_r * front;
  Float r_b = l.a_r - r_f;
  Float inv_f = Float(1.0f) / max(r_f + y_trt, Float(1.0e-20f));
  Float inv_b = Float(1.0f) / max(r_b + y_tt, Float(1.0e-20f));
  Float across_f = l.a_r * front_cos * r.x + y_trt * scatter_fringe_mean(l.n_trt) * trt.x;
  Float across_b = l.a_r * (all_cos - front_cos) * r.x - y_tt * scatter_fringe_mean(l.n_tt) * tt.x;
  ScatterGlows g;
  g.front = scatter_glow(v_splat(r_f) + l.a_trt, Vec2(across_f, r_f * r.y + y_trt * trt.y) * inv_f);
  g.back = scatter_glow(v_splat(r_b) + l.a_tt, Vec2(across_b, r_b * r.y + y_tt * tt.y) * inv_b);
  return g;
}
