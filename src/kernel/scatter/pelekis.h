// Chiang's far field as lobes that cost little: no quadrature over the fiber, no Bessel functions, an exponential a lobe.
// In the manner of Pelekis 2015 (references.bib: Pelekis2015DataDriven), fitted to Chiang 2016 instead of Marschner 2003, as
// Lipp 2026, section 3.4 has it (references.bib: Lipp2026Deferred). The numbers are in pelekis_fit.h; derivation and
// residuals: docs/derivations/pelekis.md.
//   ScatterPelekis l = scatter_prepare_pelekis(f, sin_o, cos_o)      per shading point
//   Vec3 v = scatter_pelekis(l, sin_i, cos_phi)                      per light: f cos(theta_i)
// Every lobe integrates to its energy exactly, and without absorption (and with a gain of 1) the energies sum to 1 exactly.

const float kPelekisMaxMisplaced =
    0.09f;  // share of the energy that Chiang's mean over the fiber has elsewhere; v_n >= (10 deg)^2
const float kPelekisEnergyMaxAbsError = 0.013f;  // a_r, a_tt, a_trt, a_rest; cos(theta_o) >= 0.05, eta from 1.3 to 1.8
const float kPelekisPairMaxWeight = 1.2f;        // a lobe of a pair over the density that it is drawn from
const float kPelekisFrontMaxAbsError = 0.01f;    // front_tt, front_trt against the integrals of their lobes

// A longitudinal lobe: the logistic distribution in s = sin(theta_i), trimmed to [-1, 1]. ds = cos(theta_i) d theta_i, so its
// integral is 1 by construction.
struct ScatterBand {
  Float sine;    // of theta_o - shift
  Float cosine;  // its absolute value
  Float shift;   // as in ScatterCone
  Float v;
  Float center;  // of s
  Float width;
  Float inv_width;
  Float low;    // logistic cumulative at the end of [-1, 1] that is further from the center
  Float mass;   // and what it gains over the whole of it
  Float scale;  // 1/(width mass)
};

// The same lobe with another variance. The ends are taken on the far side of the center, where neither is close to 1.
PELAGE_FN ScatterBand scatter_band_with_variance(ScatterBand b0, Float v) {
  ScatterBand b = b0;
  Float y = Float(1.0f) - b.cosine;
  Float c2 = b.cosine * b.cosine;
  Float rise = Float(2.0f) * v * v / (v + Float(kPelekisBandRise));
  Float narrow = Float(kPelekisBandNear) * v * c2;
  Float wide = v * v * (Float(1.0f) - c2 * Float(kPelekisBandFar) / (Float(kPelekisBandFar) + v));
  b.v = v;
  b.center = -b.sine * (Float(1.0f) + rise * (Float(1.0f) + y * (Float(kPelekisBandSlope) + y * Float(kPelekisBandCurve))));
  b.width = sqrt(narrow + wide);
  b.inv_width = Float(1.0f) / b.width;
  Float away = abs(b.center);
  Float near = m_exp((away - Float(1.0f)) * b.inv_width);
  Float far = m_exp(min((away + Float(1.0f)) * b.inv_width, Float(40.0f)));
  Float product = (Float(1.0f) + near) * (Float(1.0f) + far);
  b.low = Float(1.0f) / (Float(1.0f) + far);
  b.mass = (far - near) / product;
  b.scale = b.inv_width * product / (far - near);
  return b;
}
// s, k: sine and cosine of the shift.
PELAGE_FN ScatterBand scatter_band(Float sin_o, Float cos_o, Float shift, Float s, Float k, Float v) {
  ScatterBand b;
  b.sine = sin_o * k - cos_o * s;
  b.cosine = abs(cos_o * k + sin_o * s);
  b.shift = shift;
  return scatter_band_with_variance(b, v);
}
PELAGE_FN ScatterBand scatter_band_widened(ScatterBand b, Float v) { return scatter_band_with_variance(b, b.v + v); }
PELAGE_FN Float scatter_band_value(ScatterBand b, Float sin_i) {
  Float e = m_exp(-(abs(sin_i - b.center) * b.inv_width));
  Float d = Float(1.0f) + e;
  return b.scale * e / (d * d);
}
PELAGE_FN Float scatter_sample_band(ScatterBand b, Float u) {
  Float p = b.low + u * b.mass;
  Float s = b.width * m_log(p / max(Float(1.0f) - p, Float(1.0e-7f))) + abs(b.center);
  return v_clamp(select(b.center < Float(0.0f), -s, s), Float(-1.0f), Float(1.0f));
}

// A pair of azimuthal lobes at +mu and -mu, each in proportion to 1/(z - b cos x)^4 with z^2 - b^2 = 1 and b = 1/width:
// Jones & Pewsey's family (references.bib: Jones2005Circular), whose norm at a whole power is a Legendre polynomial of z.
struct ScatterFringe {
  Float z;
  Float b;
  Float b_cos;  // b cos(mu)
  Float b_sin;  // b sin(mu) >= 0
  Float norm;   // 1/(4 pi P_3(z))
  Float width;
  Float cos_mu;
};

PELAGE_FN ScatterFringe scatter_fringe(Float width2, Float tan2) {
  ScatterFringe n;
  Float w2 = max(width2, Float(1.0e-6f));
  Float z2 = Float(1.0f) + Float(1.0f) / w2;
  n.width = sqrt(w2);
  n.z = sqrt(z2);
  n.b = Float(1.0f) / n.width;
  n.cos_mu = Float(1.0f) / sqrt(Float(1.0f) + tan2);
  n.b_cos = n.b * n.cos_mu;
  n.b_sin = n.b_cos * sqrt(tan2);
  n.norm = Float(kInvTwoPi) / ((Float(5.0f) * z2 - Float(3.0f)) * n.z);
  return n;
}
// The sum of the two powers over one denominator. sin(x) >= 0.
PELAGE_FN Float scatter_fringe_value(ScatterFringe n, Float cos_x, Float sin_x) {
  Float middle = n.z - n.b_cos * cos_x;
  Float side = n.b_sin * sin_x;
  Float p = middle - side;
  Float q = middle + side;
  Float p2 = p * p;
  Float q2 = q * q;
  Float inv = Float(1.0f) / (p2 * q2);
  return n.norm * (p2 * p2 + q2 * q2) * (inv * inv);
}
// tan(y/2) = (z + b) tan(x/2) makes one lobe the cube of 1/(z - b cos x) in y, which a logistic is close to.
PELAGE_FN Float scatter_fringe_rate(ScatterFringe n) {
  Float fall = Float(kPelekisRateFall) + Float(kPelekisRateWide) * n.width;
  return Float(kPelekisRate) / sqrt(Float(1.0f) + n.width * n.width * fall);
}
PELAGE_FN Float scatter_fringe_mu(ScatterFringe n) { return m_atan2(n.b_sin, n.b_cos); }
// Azimuth from the pair's own center.
PELAGE_FN Float scatter_sample_fringe(ScatterFringe n, Float u) {
  Mask left = u < Float(0.5f);
  Float twice = u + u;
  Float y = scatter_sample_logistic(select(left, twice, twice - Float(1.0f)), scatter_fringe_rate(n)) * Float(0.5f);
  Float x = Float(2.0f) * m_atan2(m_sin(y), (n.z + n.b) * m_cos(y));
  Float mu = scatter_fringe_mu(n);
  return x + select(left, -mu, mu);
}
PELAGE_FN Float scatter_pdf_fringe_lobe(ScatterFringe n, Float rate, Float x) {
  Float half_x = Float(0.5f) * scatter_wrap(x);
  Float y = Float(2.0f) * m_atan2((n.z + n.b) * m_sin(half_x), m_cos(half_x));
  return scatter_logistic(y, rate) / (n.z - n.b * m_cos(Float(2.0f) * half_x));
}
PELAGE_FN Float scatter_pdf_fringe(ScatterFringe n, Float x) {
  Float rate = scatter_fringe_rate(n);
  Float mu = scatter_fringe_mu(n);
  return Float(0.5f) * (scatter_pdf_fringe_lobe(n, rate, x - mu) + scatter_pdf_fringe_lobe(n, rate, x + mu));
}
// Share of a pair's energy that leaves less than a quarter turn from its center, averaged over the eye's azimuth.
PELAGE_FN Float scatter_fringe_near(ScatterFringe n) {
  Float spread = Float(1.0f) + Float(kPelekisForward) * n.width * n.width;
  return Float(0.5f) + m_asin(n.cos_mu / spread) * Float(kInvPi);
}

struct ScatterPelekis {
  ScatterBand r;
  ScatterBand tt;
  ScatterBand trt;  // and of what remains
  Float a_r;        // energies
  Vec3 a_tt;
  Vec3 a_trt;
  Vec3 a_rest;  // every path after TRT, uniform in azimuth
  Float shoulder;
  Float rim;
  ScatterFringe n_tt;   // around phi = pi
  ScatterFringe n_trt;  // around phi = 0
};

// What absorption leaves of TT, TRT and the rest in one channel: x, twice the absorption along theta_t; i = 1/eta'^2.
PELAGE_FN Vec3 scatter_pelekis_transmittance(Float x, Float i, Float mirror) {
  Float chord = x * i;
  Float t = m_exp(Float(kPelekisChordTt) * chord - x);
  Float t2 = t * t;
  Float series = (Float(1.0f) - mirror) / (Float(1.0f) - mirror * t);
  return Vec3(t, t2 * (Float(1.0f) + Float(kPelekisChordTrt) * chord),
              t2 * t * (Float(1.0f) + Float(kPelekisChordRest) * chord) * series);
}

PELAGE_FN ScatterPelekis scatter_prepare_pelekis(ScatterFiber f, Float sin_o, Float cos_o_raw) {
  Float cos_o = v_clamp(cos_o_raw, Float(1.0e-4f), Float(1.0f));
  Float sin2 = Float(1.0f) - cos_o * cos_o;
  Float eta2 = f.eta * f.eta;
  Float root = min(cos_o / sqrt(eta2 - sin2), Float(kPelekisMaxRoot));
  Float x = Float(2.0f) * f.eta / sqrt(eta2 - sin2);
  Float u = v_clamp(f.eta - Float(kPelekisEta), Float(-kPelekisEtaRange), Float(kPelekisEtaRange));
  Float enter = scatter_pelekis_enter(cos_o, u);
  Float tt = enter * scatter_pelekis_leave_tt(cos_o, u);
  Float inside = enter - tt;
  Float trt = inside * scatter_pelekis_leave_trt(cos_o, u);
  Float rest = inside - trt;
  Float mirror = scatter_pelekis_mirror(cos_o);
  Vec3 t_x = scatter_pelekis_transmittance(f.sigma_a.x * x, root * root, mirror);
  Vec3 t_y = scatter_pelekis_transmittance(f.sigma_a.y * x, root * root, mirror);
  Vec3 t_z = scatter_pelekis_transmittance(f.sigma_a.z * x, root * root, mirror);
  ScatterPelekis l;
  l.a_r = f.gain_r * (Float(1.0f) - enter);
  l.a_tt = Vec3(t_x.x, t_y.x, t_z.x) * tt;
  l.a_trt = Vec3(t_x.y, t_y.y, t_z.y) * trt;
  l.a_rest = Vec3(t_x.z, t_y.z, t_z.z) * rest;
  l.shoulder = scatter_pelekis_shoulder(cos_o, u, f.v_n);
  l.rim = scatter_pelekis_rim(cos_o, u, f.v_n);
  l.n_tt = scatter_fringe(scatter_pelekis_width2_tt(root, f.v_n), scatter_pelekis_tan2_tt(root, f.v_n));
  l.n_trt = scatter_fringe(scatter_pelekis_width2_trt(root, f.v_n), scatter_pelekis_tan2_trt(root, f.v_n));
  // Shifts as scatter_prepare_chiang_far has them: -2, 1 and 4 tilts.
  Float s1 = m_sin(f.tilt);
  Float k1 = m_cos(f.tilt);
  Float s2 = Float(2.0f) * s1 * k1;
  Float k2 = Float(1.0f) - Float(2.0f) * s1 * s1;
  l.r = scatter_band(sin_o, cos_o, Float(-2.0f) * f.tilt, -s2, k2, f.v_r);
  l.tt = scatter_band(sin_o, cos_o, f.tilt, s1, k1, f.v_tt);
  l.trt = scatter_band(sin_o, cos_o, Float(4.0f) * f.tilt, Float(2.0f) * s2 * k2, Float(1.0f) - Float(2.0f) * s2 * s2, f.v_trt);
  return l;
}

// Shares that go on forward, 2 asin(h)/pi on average: of a constant in h, of 5 h^4 and of 17 h^16.
const float kPelekisEvenFront = 0.363380228f;
const float kPelekisShoulderFront = 0.660469455f;
const float kPelekisRimFront = 0.809308051f;
// N_R over A_R: in h = sin(phi/2) a constant, 5 h^4 (the shoulder) and 17 h^16 (the rim), the sum of their shares 1.
PELAGE_FN Float scatter_pelekis_reflection(ScatterPelekis l, Float cos_phi) {
  Float c2 = max(Float(0.5f) + Float(0.5f) * cos_phi, Float(0.0f));
  Float h2 = Float(1.0f) - c2;
  Float h4 = h2 * h2;
  Float h8 = h4 * h4;
  Float even = Float(1.0f) - l.shoulder - l.rim;
  return Float(0.25f) * sqrt(c2) * (even + Float(5.0f) * l.shoulder * h4 + Float(17.0f) * l.rim * (h8 * h8));
}

PELAGE_FN Vec3 scatter_pelekis(ScatterPelekis l, Float sin_i, Float cos_phi) {
  Float sin_phi = scatter_sin_phi(cos_phi);
  Float r = l.a_r * scatter_band_value(l.r, sin_i) * scatter_pelekis_reflection(l, cos_phi);
  Float tt = scatter_band_value(l.tt, sin_i) * scatter_fringe_value(l.n_tt, -cos_phi, sin_phi);
  Float m_trt = scatter_band_value(l.trt, sin_i);
  Float trt = m_trt * scatter_fringe_value(l.n_trt, cos_phi, sin_phi);
  return v_splat(r) + l.a_tt * tt + l.a_trt * trt + l.a_rest * (m_trt * Float(kInvTwoPi));
}

PELAGE_FN ScatterChoice scatter_choice_pelekis(ScatterPelekis l) { return scatter_choice(l.a_r, l.a_tt, l.a_trt, l.a_rest); }
// Everything but the pairs is drawn exactly. u.x chooses the lobe, u.y gives theta_i, u.z the part of N_R, u.w phi.
PELAGE_FN Float scatter_sample_pelekis_reflection(ScatterPelekis l, Float part, Float u) {
  Float t = abs(u + u - Float(1.0f));
  Mask is_rim = part < l.rim;
  Mask is_even = part >= l.rim + l.shoulder;
  Float h = select(is_even, t, m_pow(t, select(is_rim, Float(1.0f / 17.0f), Float(0.2f))));
  Float phi = Float(2.0f) * m_asin(h);
  return select(u < Float(0.5f), -phi, phi);
}
PELAGE_FN ScatterDirection scatter_sample_pelekis(ScatterPelekis l, ScatterChoice c, Vec4 u) {
  Float lobe = scatter_chosen(c, u.x);
  Mask is_r = lobe < Float(0.5f);
  Mask is_tt = lobe < Float(1.5f);
  Float after_r = select(is_tt, scatter_sample_band(l.tt, u.y), scatter_sample_band(l.trt, u.y));
  Float sin_i = select(is_r, scatter_sample_band(l.r, u.y), after_r);
  Float tt = Float(kPi) + scatter_sample_fringe(l.n_tt, u.w);
  Float after_tt = select(lobe < Float(2.5f), scatter_sample_fringe(l.n_trt, u.w), Float(kTwoPi) * u.w);
  Float phi = select(is_r, scatter_sample_pelekis_reflection(l, u.z, u.w), select(is_tt, tt, after_tt));
  return scatter_direction(sin_i, phi, lobe);
}
PELAGE_FN Float scatter_pdf_pelekis(ScatterPelekis l, ScatterChoice c, Float sin_i, Float phi) {
  Float m_trt = scatter_band_value(l.trt, sin_i);
  return c.r * scatter_band_value(l.r, sin_i) * scatter_pelekis_reflection(l, m_cos(phi)) +
         c.tt * scatter_band_value(l.tt, sin_i) * scatter_pdf_fringe(l.n_tt, phi - Float(kPi)) +
         m_trt * (c.trt * scatter_pdf_fringe(l.n_trt, phi) + c.rest * Float(kInvTwoPi));
}

// A Lambertian term in the manner of Kajiya & Kay for light that other fibers scattered, where no better is known.
const float kPelekisDiffused = 2.0f;  // over the color of a tuft; chosen against dual scattering: docs/derivations/pelekis.md
PELAGE_FN Vec3 scatter_pelekis_diffused(Vec3 tuft_color, Float cos_i) {
  return tuft_color * (Float(kPelekisDiffused) * scatter_diffuse(cos_i));
}
