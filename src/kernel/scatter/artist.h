// Lobes with a handle each, which do not act on each other: R, TT, TRT without its glints, and the glints.
// Sadeghi 2010 (references.bib: Sadeghi2010Artist), with lobes that integrate to 1, so that an intensity is an energy:
// docs/derivations/scattering_models.md. Angles of shifts and widths are of theta_h = (theta_i + theta_o)/2, like the paper's.

// What the artist sets. Energies are intensity times color; their sum should not exceed 1.
struct ScatterArtistFiber {
  Vec3 a_r;
  Vec3 a_tt;
  Vec3 a_trt;
  Vec3 a_glint;
  Float shift_r;  // radians
  Float shift_tt;
  Float shift_trt;  // of the glints too
  Float width_r;    // standard deviations, radians, > 0
  Float width_tt;
  Float width_trt;
  Float around_tt;  // azimuthal standard deviations, radians
  Float around_glint;
  Float glint_angle;  // half the angle between the two glints, radians
};

struct ScatterArtist {
  Float sin_o;  // of theta_o
  Float cos_o;
  ScatterCone r;
  ScatterCone tt;
  ScatterCone trt;
  Vec3 a_r;
  Vec3 a_tt;
  Vec3 a_trt;
  Vec3 a_glint;
  ScatterPair n_tt;     // one lobe around phi = pi
  ScatterPair n_glint;  // around phi = 0
  Float front_tt;       // shares that go on forward (dual_scattering.md)
  Float front_glint;
};
const float kArtistHalfFront = 0.363380228f;  // of cos(phi/2)/4: 1 - 2/pi

// A pair at +-mu of standard deviation s.
PELAGE_FN ScatterPair scatter_pair_at(Float mu, Float s) {
  Float q = m_exp(-(s * s));
  ScatterPair n;
  n.kappa = scatter_kappa(sqrt(q), Float(1.0f) - q);
  n.cos_mu = m_cos(mu);
  n.sin_mu = abs(m_sin(mu));
  n.norm = Float(0.0795774715459477f) / scatter_i0e(n.kappa);
  return n;
}
PELAGE_FN ScatterCone scatter_artist_cone(Float sin_o, Float cos_o, Float shift, Float width) {
  Float b = max(width, Float(1.0e-3f));
  return scatter_cone(sin_o, cos_o, Float(2.0f) * shift, Float(4.0f) * b * b);
}

// `color` is what light keeps that crosses the fiber once, as TT does; TRT and the glints cross it twice.
PELAGE_FN ScatterArtist scatter_prepare_sadeghi(ScatterArtistFiber f, Vec3 color, Float sin_o, Float cos_o_raw) {
  Float cos_o = max(cos_o_raw, Float(1.0e-4f));
  ScatterArtist l;
  l.sin_o = sin_o;
  l.cos_o = cos_o;
  l.r = scatter_artist_cone(sin_o, cos_o, f.shift_r, f.width_r);
  l.tt = scatter_artist_cone(sin_o, cos_o, f.shift_tt, f.width_tt);
  l.trt = scatter_artist_cone(sin_o, cos_o, f.shift_trt, f.width_trt);
  l.a_r = f.a_r;
  l.a_tt = f.a_tt * color;
  l.a_trt = f.a_trt * color * color;
  l.a_glint = f.a_glint * color * color;
  l.n_tt = scatter_pair_at(Float(0.0f), f.around_tt);
  l.n_glint = scatter_pair_at(f.glint_angle, f.around_glint);
  // As in scatter_add_offset: the mean of |x| after a blur.
  Float blurred_tt = m_exp(Float(-kInvPi) * f.around_tt * f.around_tt);
  Float blurred_glint = m_exp(Float(-kInvPi) * f.around_glint * f.around_glint) * l.n_glint.cos_mu;
  l.front_tt = Float(0.5f) + m_asin(blurred_tt) * Float(kInvPi);
  l.front_glint = Float(0.5f) - m_asin(blurred_glint) * Float(kInvPi);
  return l;
}

// N_R and N_TRT-G: cos(phi/2), normalized. Sadeghi 2010, section 4.
PELAGE_FN Float scatter_artist_half(Float cos_phi) {
  return Float(0.25f) * sqrt(max(Float(0.5f) + Float(0.5f) * cos_phi, Float(0.0f)));
}
PELAGE_FN Vec3 scatter_sadeghi(ScatterArtist l, Float sin_i, Float cos_i, Float cos_phi) {
  Float sin_phi = scatter_sin_phi(cos_phi);
  Float around = scatter_artist_half(cos_phi);
  Float zero = Float(0.0f);
  Float tt = scatter_cone_scale(l.tt, cos_i) *
             scatter_pair_value(l.n_tt, -cos_phi, sin_phi, scatter_cone_exponent(l.tt, sin_i, cos_i));
  Float trt = scatter_cone_value(l.trt, sin_i, cos_i);
  return l.a_r * (scatter_cone_value(l.r, sin_i, cos_i) * around) + l.a_tt * tt +
         (l.a_trt * around + l.a_glint * scatter_pair_value(l.n_glint, cos_phi, sin_phi, zero)) * trt;
}

// Lobe 3 are the glints.
PELAGE_FN ScatterChoice scatter_choice_sadeghi(ScatterArtist l) {
  return scatter_choice(v_luminance(l.a_r), l.a_tt, l.a_trt, l.a_glint);
}
PELAGE_FN ScatterDirection scatter_sample_sadeghi(ScatterArtist l, ScatterChoice c, Vec4 u) {
  Float lobe = scatter_chosen(c, u.x);
  Float sin_i = scatter_sample_cone(scatter_chosen_cone(lobe, l.r, l.tt, l.trt, l.trt), u.y, u.z);
  Float around = Float(2.0f) * m_asin(u.w + u.w - Float(1.0f));
  Float tt = Float(kPi) + scatter_sample_pair(l.n_tt, u.w);
  Float other = select(lobe < Float(2.5f), around, scatter_sample_pair(l.n_glint, u.w));
  Mask is_tt = (lobe > Float(0.5f)) && (lobe < Float(1.5f));
  return scatter_direction(sin_i, select(is_tt, tt, other), lobe);
}
PELAGE_FN Float scatter_pdf_sadeghi(ScatterArtist l, ScatterChoice c, Float sin_i, Float cos_i, Float phi) {
  Float around = scatter_artist_half(m_cos(phi));
  return c.r * scatter_cone_value(l.r, sin_i, cos_i) * around +
         c.tt * scatter_cone_value(l.tt, sin_i, cos_i) * scatter_pdf_pair(l.n_tt, phi - Float(kPi)) +
         scatter_cone_value(l.trt, sin_i, cos_i) * (c.trt * around + c.rest * scatter_pdf_pair(l.n_glint, phi));
}
