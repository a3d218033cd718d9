// A fiber, and its lobes as seen from one direction: what does not change from light to light is computed once.
//   ScatterFiber f = scatter_fiber(...)                                per strand (color.h makes sigma_a)
//   ScatterLobes l = scatter_prepare_marschner(f, sin_o, cos_o)      per shading point; theta_o: toward the eye
//   Vec3 v = scatter_marschner(l, sin_i, cos_i, cos_phi)             per light: f cos(theta_i)            (models.h)
//   scatter_averages, scatter_back                                   per shading point: dual scattering   (dual.h)
// sin(theta) is the direction's component along the strand, root to tip; both directions point away from the fiber.
// Derivations: docs/derivations/marschner.md.

const float kLobeEnergyMaxAbsError = 4.5e-4f;  // a_r, a_tt, a_trt, a_rest against converged quadrature over h
const float kPairMaxMisplaced = 0.075f;        // share of a pair's energy that the exact N has elsewhere; v_n >= (10 deg)^2

struct ScatterFiber {
  Vec3 sigma_a;  // absorption per fiber radius, >= 0
  Float eta;     // index of refraction, > 1
  Float gain_r;  // multiplies R; 1 is physical
  Float v_r;     // variance of theta_i + theta_o of M_R, radians^2; > 0
  Float v_tt;    //   of M_TT
  Float v_trt;   //   of M_TRT
  Float v_n;     // variance of the azimuthal blur, radians^2; >= 0
  Float tilt;    // alpha, radians
};

// An azimuthal lobe: two equal von Mises distributions at +mu and -mu (from phi = 0, or from phi = pi for TT).
struct ScatterPair {
  Float kappa;
  Float cos_mu;
  Float sin_mu;  // >= 0
  Float norm;    // 1/(4 pi I0e(kappa)): integral over phi of both is 1
};

struct ScatterLobes {
  ScatterCone r;
  ScatterCone tt;
  ScatterCone trt;
  Float sin_o;  // of theta_o itself
  Float cos_o;
  Float eta;
  Float gain_r;
  Float a_r;  // energies: integrals over the sphere
  Vec3 a_tt;
  Vec3 a_trt;
  Vec3 a_rest;        // every path after TRT: leaves uniformly in azimuth
  ScatterPair n_tt;   // around phi = pi
  ScatterPair n_trt;  // around phi = 0
  Float front_r;      // share of each lobe that goes on forward, averaged over the half circle (dual_scattering.md)
  Float front_tt;
  Float front_trt;
};

// Parameters of HairMaterial to a fiber. beta_m is the standard deviation of theta_h = (theta_i + theta_o)/2 of M_R
// (Marschner 2003, table 1), so theta_i + theta_o varies by twice that.
PELAGE_FN ScatterFiber scatter_fiber(Float eta, Float beta_m, Float beta_n, Float tilt, Float gain_r, Vec3 sigma_a) {
  ScatterFiber f;
  Float b = max(beta_m, Float(1.0e-3f));
  f.sigma_a = sigma_a;
  f.eta = eta;
  f.gain_r = gain_r;
  f.v_r = Float(4.0f) * b * b;
  f.v_tt = b * b;
  f.v_trt = Float(16.0f) * b * b;
  f.v_n = beta_n * beta_n;
  f.tilt = tilt;
  return f;
}

// Sums over the offset h across the fiber, on their way to ScatterLobes.
struct ScatterSums {
  Float a_r;
  Vec3 a_tt;
  Vec3 a_trt;
  Vec3 a_rest;
  Float front_r;
  Vec3 tt;   // energy of TT over all channels times u, u^2 and the share that goes forward; u = 1 - cos x,
             // x the exit angle from phi = pi
  Vec3 trt;  // the same of TRT, x from phi = 0
};

// One channel of one offset: (TT, TRT, rest) for the transmittance t of one crossing. Marschner 2003, eq. 8.
PELAGE_FN Vec3 scatter_attenuation(Float fresnel, Float t) {
  Float pass = (Float(1.0f) - fresnel) * (Float(1.0f) - fresnel) * t;
  Float bounce = fresnel * t;
  return Vec3(pass, pass * bounce, pass * bounce * bounce / max(Float(1.0f) - bounce, Float(1.0e-6f)));
}

// Adds the node h = sin(gamma_i) with weight w (which holds dh = cos(gamma_i) d gamma_i).
// tau = sigma_a/cos(theta_t), inv_eta2 = 1/eta'^2 (Bravais). Forward goes |phi|/pi; the mean of |x| = acos(cos x) after
// the blur is close to acos(rho cos x) with rho = e^(-v_n/pi).
PELAGE_FN ScatterSums scatter_add_offset(ScatterSums s, Float cos_o, Float eta, Vec3 tau, Float inv_eta2, Float rho,
                                         Float gamma, Float h, Float cos_i, Float w) {
  ScatterSums r = s;
  Float fresnel = scatter_fresnel(cos_o * cos_i, eta);
  Float cos_t = sqrt(Float(1.0f) - h * h * inv_eta2);
  Float sin_t = h * sqrt(inv_eta2);
  Vec3 t = v_exp(tau * (Float(-2.0f) * cos_t));
  Vec3 cx = scatter_attenuation(fresnel, t.x);
  Vec3 cy = scatter_attenuation(fresnel, t.y);
  Vec3 cz = scatter_attenuation(fresnel, t.z);
  r.a_r = s.a_r + w * fresnel;
  r.a_tt = s.a_tt + Vec3(cx.x, cy.x, cz.x) * w;
  r.a_trt = s.a_trt + Vec3(cx.y, cy.y, cz.y) * w;
  r.a_rest = s.a_rest + Vec3(cx.z, cy.z, cz.z) * w;
  r.front_r = s.front_r + w * fresnel * (gamma * Float(0.636619772367581f));
  // Exit angles (Marschner 2003, eq. 9): TT 2 gamma_t - 2 gamma_i + pi, TRT 4 gamma_t - 2 gamma_i + 2 pi.
  Float half_tt = sin_t * cos_i - cos_t * h;
  Float u_tt = Float(2.0f) * half_tt * half_tt;
  Float half_trt = Float(2.0f) * sin_t * cos_t * cos_i - (Float(1.0f) - Float(2.0f) * sin_t * sin_t) * h;
  Float u_trt = Float(2.0f) * half_trt * half_trt;
  Float e_tt = w * (cx.x + cy.x + cz.x);
  Float e_trt = w * (cx.y + cy.y + cz.y);
  Float front_tt = Float(0.5f) + m_asin(rho * (Float(1.0f) - u_tt)) * Float(kInvPi);
  Float front_trt = Float(0.5f) - m_asin(rho * (Float(1.0f) - u_trt)) * Float(kInvPi);
  r.tt = s.tt + Vec3(u_tt, u_tt * u_tt, front_tt) * e_tt;
  r.trt = s.trt + Vec3(u_trt, u_trt * u_trt, front_trt) * e_trt;
  return r;
}

// The pair with the first two trigonometric moments c1, c2 of the exit angles, blurred by e^-v_n.
// Two wrapped normals at +mu and -mu have c1 = E cos(mu), c2 = E^4 cos(2 mu); hence q = E^2 solves q^2 - 2 c1^2 q + c2 = 0.
// With u = 1 - cos x its discriminant c1^4 - c2 = a^2 (6 - 4 a + a^2) - 2 mean(u^2), a = mean(u): nothing near 1 cancels.
PELAGE_FN ScatterPair scatter_pair(Float u_sum, Float u2_sum, Float energy, Float v_n) {
  ScatterPair n;
  Float inv = Float(1.0f) / max(energy, Float(1.0e-30f));
  Float a = min(u_sum * inv, Float(2.0f));
  Float discriminant = max(a * a * (Float(6.0f) - a * (Float(4.0f) - a)) - Float(2.0f) * u2_sum * inv, Float(0.0f));
  Float spread = v_clamp(a * (Float(2.0f) - a) - sqrt(discriminant), Float(0.0f), Float(0.9999f));  // 1 - q
  Float blur = m_exp(-v_n);
  Float one_minus_q = (Float(1.0f) - blur) + blur * spread;
  n.kappa = scatter_kappa(sqrt(blur * (Float(1.0f) - spread)), one_minus_q);
  n.cos_mu = v_clamp((Float(1.0f) - a) / sqrt(Float(1.0f) - spread), Float(-1.0f), Float(1.0f));
  n.sin_mu = sqrt(Float(1.0f) - n.cos_mu * n.cos_mu);
  n.norm = Float(0.0795774715459477f) / scatter_i0e(n.kappa);
  return n;
}

// The fiber's lobes seen from theta_o. Gauss-Legendre with five nodes in gamma_i = asin(h) on [0, pi/2]; the fiber is
// symmetric, so h >= 0 is enough. Error: kLobeEnergyMaxAbsError.
PELAGE_FN ScatterLobes scatter_prepare_marschner(ScatterFiber f, Float sin_o, Float cos_o_raw) {
  Float cos_o = max(cos_o_raw, Float(1.0e-4f));
  Float sin2 = Float(1.0f) - cos_o * cos_o;
  Float inv_eta2 = cos_o * cos_o / (f.eta * f.eta - sin2);
  Float cos_theta_t = sqrt(Float(1.0f) - sin2 / (f.eta * f.eta));
  Vec3 tau = f.sigma_a * (Float(1.0f) / cos_theta_t);
  Float rho = m_exp(Float(-kInvPi) * f.v_n);
  ScatterSums s;
  Vec3 zero = Vec3(Float(0.0f), Float(0.0f), Float(0.0f));
  s.a_r = Float(0.0f);
  s.a_tt = zero;
  s.a_trt = zero;
  s.a_rest = zero;
  s.front_r = Float(0.0f);
  s.tt = zero;
  s.trt = zero;
  // clang-format off
  s = scatter_add_offset(s, cos_o, f.eta, tau, inv_eta2, rho,
                         Float(0.073686177f), Float(0.073619513f), Float(0.997286402f), Float(0.185576989f));
  s = scatter_add_offset(s, cos_o, f.eta, tau, inv_eta2, rho,
                         Float(0.362485356f), Float(0.354599180f), Float(0.935018407f), Float(0.351486583f));
  s = scatter_add_offset(s, cos_o, f.eta, tau, inv_eta2, rho,
                         Float(0.785398163f), Float(0.707106781f), Float(0.707106781f), Float(0.315938342f));
  s = scatter_add_offset(s, cos_o, f.eta, tau, inv_eta2, rho,
                         Float(1.208310971f), Float(0.935018407f), Float(0.354599180f), Float(0.133298824f));
  s = scatter_add_offset(s, cos_o, f.eta, tau, inv_eta2, rho,
                         Float(1.497110150f), Float(0.997286402f), Float(0.073619513f), Float(0.013699262f));
  // clang-format on

  ScatterLobes l;
  l.sin_o = sin_o;
  l.cos_o = cos_o;
  l.eta = f.eta;
  l.gain_r = f.gain_r;
  l.a_r = f.gain_r * s.a_r;
  l.a_tt = s.a_tt;
  l.a_trt = s.a_trt;
  l.a_rest = s.a_rest;
  Float e_tt = s.a_tt.x + s.a_tt.y + s.a_tt.z;
  Float e_trt = s.a_trt.x + s.a_trt.y + s.a_trt.z;
  l.n_tt = scatter_pair(s.tt.x, s.tt.y, e_tt, f.v_n);
  l.n_trt = scatter_pair(s.trt.x, s.trt.y, e_trt, f.v_n);
  l.front_r = s.front_r / max(s.a_r, Float(1.0e-30f));
  l.front_tt = s.tt.z / max(e_tt, Float(1.0e-30f));
  l.front_trt = s.trt.z / max(e_trt, Float(1.0e-30f));
  // Marschner 2003, table 1, as shifts of theta_i + theta_o: R toward the root, TT and TRT toward the tip.
  l.r = scatter_cone(sin_o, cos_o, Float(-2.0f) * f.tilt, f.v_r);
  l.tt = scatter_cone(sin_o, cos_o, f.tilt, f.v_tt);
  l.trt = scatter_cone(sin_o, cos_o, Float(3.0f) * f.tilt, f.v_trt);
  return l;
}

// The same for R/TT/D: R uniform in azimuth, TT one lobe of variance v_n, D isotropic with all that TRT and later paths
// carry; its cone stands for D in the averages of dual scattering (variance of theta under cos^2: pi^2/12 - 1/2).
// Zhu 2023 (references.bib: Zhu2023Practical).
PELAGE_FN ScatterLobes scatter_prepare_zhu(ScatterFiber f, Float sin_o, Float cos_o) {
  ScatterLobes l = scatter_prepare_marschner(f, sin_o, cos_o);
  Float q = m_exp(-f.v_n);
  l.n_tt.kappa = scatter_kappa(sqrt(q), Float(1.0f) - q);
  l.n_tt.cos_mu = Float(1.0f);
  l.n_tt.sin_mu = Float(0.0f);
  l.n_tt.norm = Float(0.0795774715459477f) / scatter_i0e(l.n_tt.kappa);
  l.front_r = Float(0.5f);
  l.front_tt = Float(0.5f) + m_asin(m_exp(Float(-kInvPi) * f.v_n)) * Float(kInvPi);
  l.a_rest = l.a_rest + l.a_trt;
  l.a_trt = Vec3(Float(0.0f), Float(0.0f), Float(0.0f));
  l.trt = scatter_cone(l.sin_o, l.cos_o, Float(0.0f), Float(0.322467033424113f));
  return l;
}
