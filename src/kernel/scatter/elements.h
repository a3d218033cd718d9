// The building blocks of every fiber model: Fresnel, longitudinal and azimuthal distributions.
// Derivations: docs/derivations/marschner.md. Angles: theta from the fiber's normal plane, positive toward the tip;
// phi = phi_o - phi_i in the normal plane, 0 where light returns to where it came from.

const float kI0eMaxRelError = 3.2e-4f;  // scatter_i0e, x >= 0

// e^-x I0(x), x >= 0: a polynomial in t = 1/(1 + x/1.5) through the Chebyshev nodes of I0e(x) sqrt(1 + 2 pi x).
PELAGE_FN Float scatter_i0e(Float x) {
  Float u = x + Float(1.5f);
  Float w = Float(1.0f) + Float(kTwoPi) * x;
  Float inv = Float(1.0f) / (u * w);
  Float t = Float(1.5f) * w * inv;
  Float p = Float(-8.69952486f);
  p = p * t + Float(22.108249f);
  p = p * t - Float(11.8013518f);
  p = p * t - Float(14.1015839f);
  p = p * t + Float(16.5320797f);
  p = p * t - Float(4.97244199f);
  p = p * t + Float(0.825914743f);
  p = p * t + Float(0.10865494f);
  p = p * t + Float(1.00017506f);
  return p * sqrt(u * inv);
}

// Reflectance of a dielectric for unpolarized light; cosine of the angle of incidence in [0, 1], eta > 1.
PELAGE_FN Float scatter_fresnel(Float cosine, Float eta) {
  Float inv_eta2 = Float(1.0f) / (eta * eta);
  Float cos_t = sqrt(Float(1.0f) - (Float(1.0f) - cosine * cosine) * inv_eta2);
  Float a = eta * cosine;
  Float b = eta * cos_t;
  Float parallel = (a - cos_t) * (cosine + b);
  Float perpendicular = (cosine - b) * (a + cos_t);
  Float inv = Float(1.0f) / ((a + cos_t) * (cosine + b));
  return Float(0.5f) * (parallel * parallel + perpendicular * perpendicular) * (inv * inv);
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

// A longitudinal lobe as seen from theta_o: M(theta_i, theta_o - shift), d'Eon 2011 (references.bib: dEon2011Energy).
// Integral of M cos(theta_i) d theta_i = 1 for every theta_o, shift and variance.
struct ScatterCone {
  Float sin_o;  // of theta_o - shift
  Float cos_o;  // its absolute value: I0 is even
  Float shift;  // where M peaks: theta_i + theta_o, radians
  Float v;      // variance of theta_i + theta_o, radians^2
  Float inv_v;
  Float norm;  // 1/(v (1 - e^(-2/v)))
};

PELAGE_FN ScatterCone scatter_cone_with_variance(ScatterCone c0, Float v) {
  ScatterCone c = c0;
  c.v = v;
  c.inv_v = Float(1.0f) / v;
  c.norm = c.inv_v / (Float(1.0f) - m_exp(Float(-2.0f) * c.inv_v));
  return c;
}
PELAGE_FN ScatterCone scatter_cone(Float sin_o, Float cos_o, Float shift, Float v) {
  ScatterCone c;
  Float s = m_sin(shift);
  Float k = m_cos(shift);
  c.sin_o = sin_o * k - cos_o * s;
  c.cos_o = abs(cos_o * k + sin_o * s);
  c.shift = shift;
  return scatter_cone_with_variance(c, v);
}
// M = scale e^exponent, exponent <= 0: nothing overflows, and azimuthal lobes share the exponential.
PELAGE_FN Float scatter_cone_scale(ScatterCone c, Float cos_i) { return c.norm * scatter_i0e(cos_i * c.cos_o * c.inv_v); }
// (cos(theta_i + theta_o) - 1)/v as half the squared distance of two unit vectors: exact where it is small.
PELAGE_FN Float scatter_cone_exponent(ScatterCone c, Float sin_i, Float cos_i) {
  Float x = cos_i - c.cos_o;
  Float y = sin_i + c.sin_o;
  return Float(-0.5f) * c.inv_v * (x * x + y * y);
}
PELAGE_FN Float scatter_cone_value(ScatterCone c, Float sin_i, Float cos_i) {
  return scatter_cone_scale(c, cos_i) * m_exp(scatter_cone_exponent(c, sin_i, cos_i));
}
