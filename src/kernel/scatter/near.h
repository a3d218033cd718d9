// The near field: light that meets the fiber at one offset h leaves at one azimuth for each order, blurred by a logistic.
// Chiang 2016 (references.bib: Chiang2016Practical); derivation: docs/derivations/scattering_models.md.
//   ScatterNear n = scatter_prepare_chiang(f, sin_o, cos_o, h)          per ray
//   Vec3 v = scatter_chiang(n, sin_i, cos_i, phi)                         per light: f cos(theta_i)
// h = sin(gamma_o): where the ray toward the eye leaves the fiber. phi = phi_i - phi_o has a sign here, h's.

const float kFarChiangMaxMisplaced =
    0.1f;  // share of the energy that scatter_prepare_chiang_far has elsewhere; v_n >= (10 deg)^2

struct ScatterNear {
  ScatterCone r;
  ScatterCone tt;
  ScatterCone trt;
  ScatterCone rest;
  Float a_r;  // energies; without absorption their sum is 1
  Vec3 a_tt;
  Vec3 a_trt;
  Vec3 a_rest;  // every path after TRT, uniform in azimuth
  Float phi_r;  // where each order leaves
  Float phi_tt;
  Float phi_trt;
  Float rate;  // 1/s of the logistic
};

// Chiang's roughnesses, 0...1, as HairMaterial's standard deviations in radians. Longitudinal: half the root of the
// variance of eq. 7; azimuthal: the logistic of eq. 8 has the deviation s pi/sqrt(3).
PELAGE_FN Float scatter_chiang_beta_m(Float roughness) {
  Float b = roughness;
  Float b4 = v_square(b * b);
  Float b20 = b4 * v_square(v_square(b4));
  return Float(0.5f) * (Float(0.726f) * b + Float(0.812f) * b * b + Float(3.7f) * b20);
}
PELAGE_FN Float scatter_chiang_beta_n(Float roughness) {
  Float b = roughness;
  Float b2 = b * b;
  Float b4 = b2 * b2;
  Float b22 = b2 * b4 * v_square(v_square(b4));
  Float s = Float(0.626657069f) * (Float(0.265f) * b + Float(1.194f) * b2 + Float(5.372f) * b22);
  return s * Float(1.81379936f);
}

PELAGE_FN ScatterNear scatter_prepare_chiang(ScatterFiber f, Float sin_o, Float cos_o_raw, Float h_raw) {
  Float cos_o = max(cos_o_raw, Float(1.0e-4f));
  Float h = v_clamp(h_raw, Float(-1.0f), Float(1.0f));
  Float sin2 = Float(1.0f) - cos_o * cos_o;
  Float cos_gamma = sqrt(Float(1.0f) - h * h);
  Float sin_gamma_t = h * cos_o / sqrt(f.eta * f.eta - sin2);
  Float cos_gamma_t = sqrt(Float(1.0f) - sin_gamma_t * sin_gamma_t);
  Float cos_theta_t = sqrt(Float(1.0f) - sin2 / (f.eta * f.eta));
  Vec3 t = v_exp(f.sigma_a * (Float(-2.0f) * cos_gamma_t / cos_theta_t));
  Float fresnel = scatter_fresnel(cos_o * cos_gamma, f.eta);
  Vec3 x = scatter_attenuation(fresnel, t.x);
  Vec3 y = scatter_attenuation(fresnel, t.y);
  Vec3 z = scatter_attenuation(fresnel, t.z);
  Float gamma = m_asin(h);
  Float gamma_t = m_asin(sin_gamma_t);

  ScatterNear n;
  n.a_r = f.gain_r * fresnel;
  n.a_tt = Vec3(x.x, y.x, z.x);
  n.a_trt = Vec3(x.y, y.y, z.y);
  n.a_rest = Vec3(x.z, y.z, z.z);
  n.phi_r = Float(-2.0f) * gamma;
  n.phi_tt = Float(2.0f) * (gamma_t - gamma) + Float(kPi);
  n.phi_trt = Float(4.0f) * gamma_t - Float(2.0f) * gamma;
  n.rate = Float(1.81379936f) / max(sqrt(f.v_n), Float(1.0e-2f));
  n.r = scatter_cone(sin_o, cos_o, Float(-2.0f) * f.tilt, f.v_r);
  n.tt = scatter_cone(sin_o, cos_o, f.tilt, f.v_tt);
  n.trt = scatter_cone(sin_o, cos_o, Float(4.0f) * f.tilt, f.v_trt);
  n.rest = scatter_cone(sin_o, cos_o, Float(0.0f), f.v_trt);
  return n;
}

// The mean over h, as lobes for scatter_marschner: energies are the same means, the blur has the same variance, R is not
// blurred around the fiber, and what remains keeps TRT's tilt. Error: kFarChiangMaxMisplaced.
PELAGE_FN ScatterLobes scatter_prepare_chiang_far(ScatterFiber f, Float sin_o, Float cos_o) {
  ScatterLobes l = scatter_prepare_marschner(f, sin_o, cos_o);
  l.trt = scatter_cone(sin_o, l.cos_o, Float(4.0f) * f.tilt, f.v_trt);
  return l;
}

PELAGE_FN Vec3 scatter_chiang(ScatterNear n, Float sin_i, Float cos_i, Float phi) {
  Float r = scatter_cone_value(n.r, sin_i, cos_i) * scatter_logistic(scatter_wrap(phi - n.phi_r), n.rate);
  Float tt = scatter_cone_value(n.tt, sin_i, cos_i) * scatter_logistic(scatter_wrap(phi - n.phi_tt), n.rate);
  Float trt = scatter_cone_value(n.trt, sin_i, cos_i) * scatter_logistic(scatter_wrap(phi - n.phi_trt), n.rate);
  Float rest = scatter_cone_value(n.rest, sin_i, cos_i) * Float(kInvTwoPi);
  return v_splat(n.a_r * r) + n.a_tt * tt + n.a_trt * trt + n.a_rest * rest;
}

PELAGE_FN ScatterChoice scatter_choice_chiang(ScatterNear n) { return scatter_choice(n.a_r, n.a_tt, n.a_trt, n.a_rest); }
// Every factor is drawn exactly: with one channel value/pdf is the sum of the energies, everywhere.
PELAGE_FN ScatterDirection scatter_sample_chiang(ScatterNear n, ScatterChoice c, Vec4 u) {
  Float lobe = scatter_chosen(c, u.x);
  Float sin_i = scatter_sample_cone(scatter_chosen_cone(lobe, n.r, n.tt, n.trt, n.rest), u.y, u.z);
  Float center = select(lobe < Float(0.5f), n.phi_r, select(lobe < Float(1.5f), n.phi_tt, n.phi_trt));
  Float phi = select(lobe < Float(2.5f), center + scatter_sample_logistic(u.w, n.rate), Float(kTwoPi) * u.w);
  return scatter_direction(sin_i, phi, lobe);
}
PELAGE_FN Float scatter_pdf_chiang(ScatterNear n, ScatterChoice c, Float sin_i, Float cos_i, Float phi) {
  return c.r * scatter_cone_value(n.r, sin_i, cos_i) * scatter_logistic(scatter_wrap(phi - n.phi_r), n.rate) +
         c.tt * scatter_cone_value(n.tt, sin_i, cos_i) * scatter_logistic(scatter_wrap(phi - n.phi_tt), n.rate) +
         c.trt * scatter_cone_value(n.trt, sin_i, cos_i) * scatter_logistic(scatter_wrap(phi - n.phi_trt), n.rate) +
         c.rest * scatter_cone_value(n.rest, sin_i, cos_i) * Float(kInvTwoPi);
}
