// The building blocks of every fiber model: Fresnel, longitudinal and azimuthal distributions.
// Derivations: docs/derivations/marschner.md. Angles: theta from the fiber's normal plane, positive toward the tip;
// phi = phi_o - phi_i in the normal plane, 0 where light returns to where it came from.

const float kI0eMaxRelError = 3.2e-4f;  // scatter_i0e, x >= 0

// e^-x I0(x), x >= 0: a polynomial in t = 1/(1 + x/1.5) through the Chebyshev nodes of I0e(x) sqrt(1 + 2 pi x).
PELAGE_FN Float scatter_i0e(Float x) {
  Float t = Float(1.5f) / (x + Float(1.5f));
  Float p = Float(-8.69952486f);
  p = p * t + Float(22.108249f);
  p = p * t - Float(11.8013518f);
  p = p * t - Float(14.1015839f);
  p = p * t + Float(16.5320797f);
  p = p * t - Float(4.97244199f);
  p = p * t + Float(0.825914743f);
  p = p * t + Float(0.10865494f);
  p = p * t + Float(1.00017506f);
  return p / sqrt(Float(1.0f) + Float(kTwoPi) * x);
}

// Reflectance of a dielectric for unpolarized light; cosine of the angle of incidence in [0, 1], eta > 1.
PELAGE_FN Float scatter_fresnel(Float cosine, Float eta) {
  Float sin2 = Float(1.0f) - cosine * cosine;
  Float cos_t = sqrt(Float(1.0f) - sin2 / (eta * eta));
  Float parallel = (eta * cosine - cos_t) / (eta * cosine + cos_t);
  Float perpendicular = (cosine - eta * cos_t) / (cosine + eta * cos_t);
  return Float(0.5f) * (parallel * parallel + perpendicular * perpendicular);
}

// 1/(v (1 - e^(-2/v))): the factor of M that depends on the variance alone.
PELAGE_FN Float scatter_longitudinal_norm(Float v) {
  return Float(1.0f) / (v * (Float(1.0f) - m_exp(Float(-2.0f) / v)));
}

// M(theta_i, theta_o) without its exponential: d'Eon 2011, eq. 7, scaled by e^(...) so that nothing overflows
// (references.bib: dEon2011Energy). Integral of M cos(theta_i) d theta_i = 1 for every theta_o and v.
PELAGE_FN Float scatter_longitudinal_scale(Float cos_i, Float cos_o, Float v, Float norm) {
  return norm * scatter_i0e(cos_i * cos_o / v);
}
// The exponent of M, (cos(theta_i + theta_o) - 1)/v <= 0, without cancellation where the sum is small.
PELAGE_FN Float scatter_longitudinal_exponent(Float sin_i, Float cos_i, Float sin_o, Float cos_o, Float v) {
  Float c = cos_i * cos_o - sin_i * sin_o;
  Float s = sin_i * cos_o + cos_i * sin_o;
  Float one_minus_c = select(c > Float(0.0f), s * s / (Float(1.0f) + abs(c)), Float(1.0f) - c);
  return -(one_minus_c / v);
}
PELAGE_FN Float scatter_longitudinal(Float sin_i, Float cos_i, Float sin_o, Float cos_o, Float v) {
  return scatter_longitudinal_scale(cos_i, cos_o, v, scatter_longitudinal_norm(v)) *
         m_exp(scatter_longitudinal_exponent(sin_i, cos_i, sin_o, cos_o, v));
}

// Concentration of the von Mises distribution with mean resultant length r in [0, 1) (Banerjee 2005, eq. 4.4 with p = 2;
// references.bib: Banerjee2005Clustering); one_minus_r2 = 1 - r^2. Capped: a standard deviation below 0.01 rad acts as that.
PELAGE_FN Float scatter_kappa(Float r, Float one_minus_r2) {
  return min(r * (Float(1.0f) + one_minus_r2) / max(one_minus_r2, Float(1.0e-4f)), Float(1.0e4f));
}

// A hemisphere of azimuths around phi = 0 with a soft edge; integral over phi = 1 for every sharpness, because
// logistic(x) + logistic(-x) = 1. Negative sharpness: around phi = pi.
PELAGE_FN Float scatter_half_circle(Float sharpness, Float cos_phi) {
  return Float(kInvPi) / (Float(1.0f) + m_exp(-(sharpness * cos_phi)));
}
