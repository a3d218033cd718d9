// Drawing the direction of light for a given theta_o: a lobe by its energy, theta_i from the lobe's cone exactly, the
// azimuth from a density close to the lobe's whose value is known exactly. Always four numbers u in [0, 1) a direction.
//   ScatterChoice c = scatter_choice(...)                                  per shading point
//   ScatterDirection d = scatter_sample_marschner(l, c, u)
//   Float p = scatter_pdf_marschner(l, c, d.sin_i, d.cos_i, d.phi)         per solid angle, all lobes together
// Derivations: docs/derivations/scattering_models.md.

const float kReflectionMaxWeight = 1.5f;  // N_R over a_r times its sampling density; eta from 1.2 to 3
const float kPairMaxWeight = 1.27f;       // a von Mises lobe over the logistic that it is sampled from

// Probability of each lobe; their sum is 1, or 0 where nothing is scattered.
struct ScatterChoice {
  Float r;
  Float tt;
  Float trt;
  Float rest;
};

struct ScatterDirection {
  Float sin_i;
  Float cos_i;
  Float phi;   // from the azimuth of omega_o, radians, any number of turns
  Float lobe;  // 0 R, 1 TT, 2 TRT, 3 rest
};

PELAGE_FN ScatterChoice scatter_choice(Float r, Vec3 tt, Vec3 trt, Vec3 rest) {
  Float y_tt = v_luminance(tt);
  Float y_trt = v_luminance(trt);
  Float y_rest = v_luminance(rest);
  Float inv = Float(1.0f) / max(r + y_tt + y_trt + y_rest, Float(1.0e-30f));
  ScatterChoice c;
  c.r = r * inv;
  c.tt = y_tt * inv;
  c.trt = y_trt * inv;
  c.rest = y_rest * inv;
  return c;
}
PELAGE_FN ScatterChoice scatter_choice_of(ScatterLobes l) { return scatter_choice(l.a_r, l.a_tt, l.a_trt, l.a_rest); }
// The lobe that u chooses: 0, 1, 2 or 3.
PELAGE_FN Float scatter_chosen(ScatterChoice c, Float u) {
  Float two = c.r + c.tt;
  Float after_trt = select(u < two + c.trt, Float(2.0f), Float(3.0f));
  return select(u < c.r, Float(0.0f), select(u < two, Float(1.0f), after_trt));
}

// sin(theta_i) with the density M(theta_i) cos(theta_i): d'Eon 2013, eq. 3 (references.bib: dEon2013Importance). M is a
// von Mises-Fisher lobe on the sphere seen from its axis at -(theta_o - shift), so a point of that lobe is drawn and turned.
PELAGE_FN Float scatter_sample_cone(ScatterCone c, Float u, Float w) {
  Float a = m_exp(Float(-2.0f) * c.inv_v);
  Float x = v_clamp(-c.v * m_log(u + (Float(1.0f) - u) * a), Float(0.0f), Float(2.0f));  // 1 - cosine from the axis
  Float sine = sqrt(x * (Float(2.0f) - x));
  Float s = sine * m_cos(Float(kTwoPi) * w) * c.cos_o - (Float(1.0f) - x) * c.sin_o;
  return v_clamp(s, Float(-1.0f), Float(1.0f));
}
// What scatter_sample_cone reads, of the cone of the chosen lobe.
PELAGE_FN ScatterCone scatter_chosen_cone(Float lobe, ScatterCone r, ScatterCone tt, ScatterCone trt, ScatterCone rest) {
  Mask is_r = lobe < Float(0.5f);
  Mask is_tt = lobe < Float(1.5f);
  Mask is_trt = lobe < Float(2.5f);
  ScatterCone c = rest;
  c.sin_o = select(is_r, r.sin_o, select(is_tt, tt.sin_o, select(is_trt, trt.sin_o, c.sin_o)));
  c.cos_o = select(is_r, r.cos_o, select(is_tt, tt.cos_o, select(is_trt, trt.cos_o, c.cos_o)));
  c.v = select(is_r, r.v, select(is_tt, tt.v, select(is_trt, trt.v, c.v)));
  c.inv_v = select(is_r, r.inv_v, select(is_tt, tt.inv_v, select(is_trt, trt.inv_v, c.inv_v)));
  return c;
}

// The logistic distribution of scale s = 1/inv_s trimmed to [-pi, pi].
PELAGE_FN Float scatter_logistic_mass(Float inv_s) {
  Float e = m_exp(-(Float(kPi) * inv_s));
  return (Float(1.0f) - e) / (Float(1.0f) + e);
}
PELAGE_FN Float scatter_logistic(Float x, Float inv_s) {
  Float e = m_exp(-(abs(x) * inv_s));
  Float d = Float(1.0f) + e;
  return e * inv_s / (d * d * scatter_logistic_mass(inv_s));
}
PELAGE_FN Float scatter_sample_logistic(Float u, Float inv_s) {
  Float p = Float(0.5f) + (u - Float(0.5f)) * scatter_logistic_mass(inv_s);
  Float x = m_log(p / max(Float(1.0f) - p, Float(1.0e-7f))) / inv_s;
  return v_clamp(x, -Float(kPi), Float(kPi));
}
// x to [-pi, pi], by whole turns.
PELAGE_FN Float scatter_wrap(Float x) {
  PELAGE_EXACT Float r = x - Float(kTwoPi) * floor(x * Float(kInvTwoPi) + Float(0.5f));
  return r;
}

// 1/s of the logistic that a von Mises lobe is sampled from. Its limits: kappa -> 0, where both are even with equal
// first harmonic over the circle (s^2 = pi^2/8 kappa), and a normal distribution with the same peak (s^2 = pi/8 kappa).
PELAGE_FN Float scatter_pair_rate(Float kappa) {
  Float k = max(kappa, Float(1.0e-3f));
  return sqrt(k * (Float(0.810569469f) + Float(1.73590962f) * k / (k + Float(4.0f))));
}
PELAGE_FN Float scatter_pair_mu(ScatterPair n) { return m_atan2(n.sin_mu, n.cos_mu); }
// Azimuth from the pair's own center (phi = pi for TT, phi = 0 for TRT).
PELAGE_FN Float scatter_sample_pair(ScatterPair n, Float u) {
  Mask left = u < Float(0.5f);
  Float twice = u + u;
  Float x = scatter_sample_logistic(select(left, twice, twice - Float(1.0f)), scatter_pair_rate(n.kappa));
  Float mu = scatter_pair_mu(n);
  return x + select(left, -mu, mu);
}
PELAGE_FN Float scatter_pdf_pair(ScatterPair n, Float x) {
  Float rate = scatter_pair_rate(n.kappa);
  Float mu = scatter_pair_mu(n);
  return Float(0.5f) * (scatter_logistic(scatter_wrap(x - mu), rate) + scatter_logistic(scatter_wrap(x + mu), rate));
}

// N_R in h = sin(phi/2) is F(h)/2. It is drawn as a constant, F(0), and what is above it: two powers of h, one that meets F
// at h = 1 and a lower one for the shoulder.
const float kReflectionSteep = 0.7f;  // share of the first power; both numbers by search over eta and theta_o
const float kReflectionBroad = 6.0f;  // its exponent over the second's
struct ScatterReflectionDensity {
  Float excess;  // share of both powers
  Float steep;   // exponents plus one
  Float broad;
};
PELAGE_FN ScatterReflectionDensity scatter_reflection_density(ScatterLobes l) {
  Float least = scatter_fresnel(min(l.cos_o, Float(1.0f)), l.eta);
  Float mean = select(l.gain_r > Float(0.0f), l.a_r / max(l.gain_r, Float(1.0e-30f)), Float(1.0f));
  Float above = max(mean - least, Float(1.0e-4f));
  ScatterReflectionDensity d;
  d.excess = min(above / (above + least), Float(0.9f));
  d.steep = max((Float(1.0f) - least) / above, Float(1.0f));
  d.broad = max(d.steep / Float(kReflectionBroad), Float(1.0f));
  return d;
}
PELAGE_FN Float scatter_sample_reflection(ScatterLobes l, Float u) {
  ScatterReflectionDensity d = scatter_reflection_density(l);
  Float t = abs(u + u - Float(1.0f));
  Float even = Float(1.0f) - d.excess;
  Float inv = Float(1.0f) / d.excess;
  Float x = (t - even) * inv;  // in the excess, [0, 1)
  Mask is_steep = x < Float(kReflectionSteep);
  Float y = select(is_steep, x / Float(kReflectionSteep), (x - Float(kReflectionSteep)) / Float(1.0f - kReflectionSteep));
  Float root = m_pow(v_clamp(y, Float(0.0f), Float(1.0f)), Float(1.0f) / select(is_steep, d.steep, d.broad));
  Float phi = Float(2.0f) * m_asin(select(t < even, t / even, root));
  return select(u < Float(0.5f), -phi, phi);
}
PELAGE_FN Float scatter_pdf_reflection(ScatterLobes l, Float phi) {
  ScatterReflectionDensity d = scatter_reflection_density(l);
  Float x = Float(0.5f) * scatter_wrap(phi);
  Float h = abs(m_sin(x));
  Float steep = d.steep * m_pow(h, d.steep - Float(1.0f));
  Float broad = d.broad * m_pow(h, d.broad - Float(1.0f));
  Float above = Float(kReflectionSteep) * steep + Float(1.0f - kReflectionSteep) * broad;
  return Float(0.25f) * abs(m_cos(x)) * ((Float(1.0f) - d.excess) + d.excess * above);
}

// sin(theta_i) with the density cos^2(theta_i) 2/pi: the abscissa of a point spread evenly over the unit disk.
PELAGE_FN Float scatter_sample_diffuse(Float u, Float w) { return sqrt(u) * m_cos(Float(kTwoPi) * w); }

PELAGE_FN ScatterDirection scatter_direction(Float sin_i, Float phi, Float lobe) {
  ScatterDirection d;
  d.sin_i = sin_i;
  d.cos_i = sqrt(max(Float(1.0f) - sin_i * sin_i, Float(0.0f)));
  d.phi = phi;
  d.lobe = lobe;
  return d;
}

// u.x chooses the lobe, u.y and u.z theta_i, u.w phi.
PELAGE_FN ScatterDirection scatter_sample_marschner(ScatterLobes l, ScatterChoice c, Vec4 u) {
  Float lobe = scatter_chosen(c, u.x);
  Float sin_i = scatter_sample_cone(scatter_chosen_cone(lobe, l.r, l.tt, l.trt, l.trt), u.y, u.z);
  Float r = scatter_sample_reflection(l, u.w);
  Float tt = Float(kPi) + scatter_sample_pair(l.n_tt, u.w);
  Float trt = scatter_sample_pair(l.n_trt, u.w);
  Float after_tt = select(lobe < Float(2.5f), trt, Float(kTwoPi) * u.w);
  Float phi = select(lobe < Float(0.5f), r, select(lobe < Float(1.5f), tt, after_tt));
  return scatter_direction(sin_i, phi, lobe);
}
PELAGE_FN Float scatter_pdf_marschner(ScatterLobes l, ScatterChoice c, Float sin_i, Float cos_i, Float phi) {
  Float m_trt = scatter_cone_value(l.trt, sin_i, cos_i);
  return c.r * scatter_cone_value(l.r, sin_i, cos_i) * scatter_pdf_reflection(l, phi) +
         c.tt * scatter_cone_value(l.tt, sin_i, cos_i) * scatter_pdf_pair(l.n_tt, phi - Float(kPi)) +
         m_trt * (c.trt * scatter_pdf_pair(l.n_trt, phi) + c.rest * Float(kInvTwoPi));
}

PELAGE_FN ScatterDirection scatter_sample_zhu(ScatterLobes l, ScatterChoice c, Vec4 u) {
  Float lobe = scatter_chosen(c, u.x);
  Float cone = scatter_sample_cone(scatter_chosen_cone(lobe, l.r, l.tt, l.trt, l.trt), u.y, u.z);
  Mask is_tt = (lobe > Float(0.5f)) && (lobe < Float(1.5f));
  Float phi = select(is_tt, Float(kPi) + scatter_sample_pair(l.n_tt, u.w), Float(kTwoPi) * u.w);
  return scatter_direction(select(lobe < Float(1.5f), cone, scatter_sample_diffuse(u.y, u.z)), phi, lobe);
}
PELAGE_FN Float scatter_pdf_zhu(ScatterLobes l, ScatterChoice c, Float sin_i, Float cos_i, Float phi) {
  return c.r * scatter_cone_value(l.r, sin_i, cos_i) * Float(kInvTwoPi) +
         c.tt * scatter_cone_value(l.tt, sin_i, cos_i) * scatter_pdf_pair(l.n_tt, phi - Float(kPi)) +
         c.rest * scatter_diffuse(cos_i);
}

// Of Kajiya & Kay's lobes: the highlight is R, the diffuse lobe the rest.
PELAGE_FN ScatterChoice scatter_choice_kajiya_kay(ScatterLobes l, Vec3 color) {
  Vec3 none = Vec3(Float(0.0f), Float(0.0f), Float(0.0f));
  return scatter_choice(l.a_r, none, none, color * max(Float(1.0f) - l.a_r, Float(0.0f)));
}
PELAGE_FN ScatterDirection scatter_sample_kajiya_kay(ScatterLobes l, ScatterChoice c, Vec4 u) {
  Float lobe = scatter_chosen(c, u.x);
  Float cone = scatter_sample_cone(l.r, u.y, u.z);
  return scatter_direction(select(lobe < Float(0.5f), cone, scatter_sample_diffuse(u.y, u.z)), Float(kTwoPi) * u.w, lobe);
}
PELAGE_FN Float scatter_pdf_kajiya_kay(ScatterLobes l, ScatterChoice c, Float sin_i, Float cos_i) {
  return c.r * scatter_cone_value(l.r, sin_i, cos_i) * Float(kInvTwoPi) + c.rest * scatter_diffuse(cos_i);
}
