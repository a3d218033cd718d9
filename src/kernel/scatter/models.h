// The single-fiber models: each returns f(omega_i, omega_o) cos(theta_i) per channel, always finite, so that
//   L_o = integral of L_i f cos(theta_i) d omega_i
// is a plain integral over solid angle. Energies, and why f is not reciprocal: docs/derivations/marschner.md.
// sin_i, cos_i: of theta_i, cos_i >= 0. cos_phi: of phi_o - phi_i.

// N of a pair around phi = 0, times e^exponent (the longitudinal lobe's, to save its exponential).
PELAGE_FN Float scatter_pair_value(ScatterPair n, Float cos_phi, Float sin_phi, Float exponent) {
  Float c = cos_phi * n.cos_mu - Float(1.0f);
  Float s = sin_phi * n.sin_mu;
  return n.norm * (m_exp(n.kappa * (c + s) + exponent) + m_exp(n.kappa * (c - s) + exponent));
}

// sin(phi) >= 0: every lobe is even in phi.
PELAGE_FN Float scatter_sin_phi(Float cos_phi) { return sqrt(max(Float(1.0f) - cos_phi * cos_phi, Float(0.0f))); }

// N_R = F(h) |dh/dphi|/2 with h = sin(phi/2): Marschner 2003, eq. 7 and 8. Integral over phi: a_r.
PELAGE_FN Float scatter_reflection(ScatterLobes l, Float cos_phi) {
  Float c = sqrt(max(Float(0.5f) + Float(0.5f) * cos_phi, Float(0.0f)));
  return Float(0.25f) * l.gain_r * c * scatter_fresnel(l.cos_o * min(c, Float(1.0f)), l.eta);
}

// R, TT, TRT and the rest; `l` from scatter_prepare_marschner. Marschner 2003 (references.bib: Marschner2003Light) with
// d'Eon's M.
PELAGE_FN Vec3 scatter_marschner(ScatterLobes l, Float sin_i, Float cos_i, Float cos_phi) {
  Float sin_phi = scatter_sin_phi(cos_phi);
  Float r = scatter_cone_value(l.r, sin_i, cos_i) * scatter_reflection(l, cos_phi);
  Float tt = scatter_cone_scale(l.tt, cos_i) *
             scatter_pair_value(l.n_tt, -cos_phi, sin_phi, scatter_cone_exponent(l.tt, sin_i, cos_i));
  Float scale = scatter_cone_scale(l.trt, cos_i);
  Float exponent = scatter_cone_exponent(l.trt, sin_i, cos_i);
  Float trt = scale * scatter_pair_value(l.n_trt, cos_phi, sin_phi, exponent);
  Float rest = scale * m_exp(exponent) * Float(kInvTwoPi);
  return v_splat(r) + l.a_tt * tt + l.a_trt * trt + l.a_rest * rest;
}

// The diffuse lobe: f = 1/pi^2, the same everywhere; energy 1.
PELAGE_FN Float scatter_diffuse(Float cos_i) { return Float(0.101321183642338f) * cos_i; }

// R uniform in azimuth, TT, and D; `l` from scatter_prepare_zhu. Zhu 2023 (references.bib: Zhu2023Practical).
PELAGE_FN Vec3 scatter_zhu(ScatterLobes l, Float sin_i, Float cos_i, Float cos_phi) {
  Float r = scatter_cone_value(l.r, sin_i, cos_i) * l.a_r * Float(kInvTwoPi);
  Float tt = scatter_cone_scale(l.tt, cos_i) *
             scatter_pair_value(l.n_tt, -cos_phi, scatter_sin_phi(cos_phi), scatter_cone_exponent(l.tt, sin_i, cos_i));
  return v_splat(r) + l.a_tt * tt + l.a_rest * scatter_diffuse(cos_i);
}

// Diffuse of energy (1 - a_r) color, and a highlight uniform in azimuth of energy a_r: Kajiya & Kay 1989
// (references.bib: Kajiya1989Fur); cos^p becomes the exponential of equal curvature, p = 1/v, which normalizes exactly.
PELAGE_FN Vec3 scatter_kajiya_kay(ScatterLobes l, Vec3 color, Float sin_i, Float cos_i) {
  Float s = scatter_cone_value(l.r, sin_i, cos_i) * l.a_r * Float(kInvTwoPi);
  return v_splat(s) + color * (max(Float(1.0f) - l.a_r, Float(0.0f)) * scatter_diffuse(cos_i));
}
