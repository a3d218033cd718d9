// Shared by the three targets of the parity test, in the kernel subset: every result becomes four numbers.

const float kParityRounding = 1.0e-6f;  // GLSL may contract a·b + c and divide to within 2.5 ulp: a few roundings
const float kParityPow = 4.0e-6f;       // e^(y·log x): the error of the logarithm grows with y
const float kParityScatter = 4.0e-6f;   // some ten roundings and elementary functions in a row
const float kParityLobe = 5.0e-5f;      // exponents and concentrations of narrow lobes multiply those errors
const float kParityDraw = 1.0e-4f;      // densities are steep: the error of a direction comes back multiplied
const float kParityBundle = 2.0e-4f;    // difference quotients of close values
const float kParityArea = 1.0e-5f;      // roundings of a band's height, some pixels, against an area below 1
const float kParityGgx = 1.0e-5f;       // the narrow peak multiplies the error of the half vector

PELAGE_FN Vec4 parity_result(Float x) { return Vec4(x, Float(0.0f), Float(0.0f), Float(0.0f)); }
PELAGE_FN Vec4 parity_result(Vec2 v) { return Vec4(v.x, v.y, Float(0.0f), Float(0.0f)); }
PELAGE_FN Vec4 parity_result(Vec3 v) { return Vec4(v.x, v.y, v.z, Float(0.0f)); }
PELAGE_FN Vec4 parity_result(Vec4 v) { return v; }
PELAGE_FN Vec4 parity_result(Mask m) { return parity_result(select(m, Float(1.0f), Float(0.0f))); }

// A band from (a, b) to (c, d) with radii e and f, between 1 and 2 m away, with caps across it.
PELAGE_FN RasterBand parity_band(Float a, Float b, Float c, Float d, Float e, Float f) {
  Vec3 across = v_normalize(Vec3(b - d, c - a, Float(0.0f)));
  return raster_band(Vec2(a, b), Vec2(c, d), e, f, Float(1.0f), Float(2.0f), Vec2(across.y, Float(0.0f) - across.x),
                     Vec2(across.y, Float(0.0f) - across.x));
}
PELAGE_FN Vec4 parity_band_shape(RasterBand r) { return Vec4(raster_band_center(r, Float(1.0f)), r.slope, r.first, r.last); }

// A kernel all of whose terms are at work.
PELAGE_FN FilterKernel parity_filter_kernel(Float inverse) {
  FilterKernel k;
  k.inverse_major2 = inverse;
  k.inverse_minor2 = inverse * Float(3.0f);
  k.inverse_distance2 = inverse * Float(0.5f);
  k.inverse_angle2 = inverse;
  k.inverse_color2 = inverse * Float(2.0f);
  k.half_inverse_along2 = inverse * Float(0.25f);
  k.half_inverse_across2 = inverse * Float(0.75f);
  return k;
}

PELAGE_FN Vec4 parity_harmonics_low(Vec3 n) {
  LightHarmonics h = light_harmonics(n);
  return Vec4(h.c00, h.c1n, h.c10, h.c1p);
}
PELAGE_FN Vec4 parity_harmonics_high(Vec3 n) {
  LightHarmonics h = light_harmonics(n);
  return Vec4(h.c2nn + h.c2n, h.c20, h.c2p, h.c2pp);
}

// A fiber of one melanin concentration, seen from theta_o.
PELAGE_FN ScatterFiber parity_fiber(Float beta_m, Float beta_n, Float eumelanin, Float eta, Float tilt) {
  return scatter_fiber(eta, beta_m, beta_n, tilt, Float(1.0f), scatter_melanin(eumelanin, Float(0.2f)));
}
PELAGE_FN ScatterLobes parity_lobes(Float theta_o, Float beta_m, Float beta_n, Float eumelanin, Float eta, Float tilt) {
  return scatter_prepare_marschner(parity_fiber(beta_m, beta_n, eumelanin, eta, tilt), m_sin(theta_o), m_cos(theta_o));
}
PELAGE_FN ScatterLobes parity_lobes_zhu(Float theta_o, Float beta_m, Float beta_n, Float eumelanin, Float eta, Float tilt) {
  return scatter_prepare_zhu(parity_fiber(beta_m, beta_n, eumelanin, eta, tilt), m_sin(theta_o), m_cos(theta_o));
}
PELAGE_FN Vec4 parity_energies(ScatterLobes l) { return Vec4(l.a_r, l.a_tt.x, l.a_trt.y, l.a_rest.z); }
PELAGE_FN Vec4 parity_pairs(ScatterLobes l) { return Vec4(l.n_tt.cos_mu, l.n_tt.norm, l.n_trt.cos_mu, l.n_trt.norm); }
PELAGE_FN Vec3 parity_fronts(ScatterLobes l) { return Vec3(l.front_r, l.front_tt, l.front_trt); }
PELAGE_FN Vec4 parity_averages(ScatterAverages a) { return Vec4(a.a_f.x, a.a_b.y, a.v_f + a.v_b, a.shift_f + a.shift_b); }
PELAGE_FN Vec4 parity_back(ScatterLobes l) {
  ScatterBack b = scatter_back(scatter_averages(l), l.sin_o, l.cos_o);
  return Vec4(b.a.x, b.a.z, b.cone.v, b.cone.shift);
}
// On a table that is linear in row and column, so that a cell chosen differently at an edge gives the same value.
PELAGE_FN Float parity_table(Float cos_theta, Float sigma_a) {
  ScatterTableCell c = scatter_table_cell(cos_theta, sigma_a);
  Float v = c.index * Float(0.001f);
  return scatter_table_mix(c, v, v + Float(0.001f), v + Float(0.065f), v + Float(0.066f));
}
PELAGE_FN Vec3 parity_local(ScatterLobes l, Float v, Float theta_i, Float cos_phi) {
  return scatter_dual_local(scatter_back(scatter_averages(l), l.sin_o, l.cos_o), v, m_sin(theta_i), m_cos(theta_i), cos_phi);
}

// A drawn direction and its density; the last of u is taken from c. Azimuths as cosines: a whole turn more is the same.
PELAGE_FN Vec4 parity_drawn(ScatterDirection d, Float pdf) { return Vec4(d.sin_i, m_cos(d.phi), d.lobe, pdf); }
PELAGE_FN Vec4 parity_draw_marschner(ScatterLobes l, Vec4 u) {
  ScatterChoice c = scatter_choice_of(l);
  ScatterDirection d = scatter_sample_marschner(l, c, u);
  return parity_drawn(d, scatter_pdf_marschner(l, c, d.sin_i, d.cos_i, d.phi));
}
// A bundle of half the width `wide`, 2 mm deep, of hairs of 80 um.
PELAGE_FN ScatterAggregate parity_aggregate(ScatterLobes l, Float hairs, Float wide) {
  return scatter_prepare_aggregate(l, scatter_bundle_buffon(hairs, Float(4.0e-5f), wide, Float(2.0e-3f)));
}
PELAGE_FN Vec4 parity_bundle(ScatterBundle b, Float cos_phi, Float loss) {
  return Vec4(scatter_bundle_crossings(b, cos_phi), scatter_bundle_coverage(b),
              scatter_bundle_visible(b, scatter_bundle_way(b, cos_phi), loss),
              scatter_bundle_escape(b) + scatter_bundle_clumping(b, loss));
}
PELAGE_FN Vec4 parity_terms(ScatterAggregateTerms t) { return Vec4(t.forward, t.back, t.side, t.masked); }
PELAGE_FN Vec4 parity_aggregate_energies(ScatterAggregate a) { return Vec4(a.a_back.x, a.a_back.z, a.back.v, a.straight.tt.y); }
PELAGE_FN Vec3 parity_aggregate_marschner(ScatterAggregate a, Float theta_i, Float cos_phi) {
  return scatter_aggregate_marschner(a, scatter_shares(a, cos_phi), m_sin(theta_i), m_cos(theta_i), cos_phi);
}
// The paper's model and its formula for n.
PELAGE_FN Vec3 parity_aggregate_zhu(ScatterLobes l, Float hairs, Float wide, Float theta_i, Float cos_phi) {
  ScatterAggregateTerms t = scatter_terms_huang();
  ScatterAggregate a = scatter_prepare_huang(l, scatter_bundle_huang(hairs, Float(4.0e-5f), wide, Float(2.0e-3f)), t);
  return scatter_aggregate_zhu(a, scatter_shares_huang(a, t, cos_phi), m_sin(theta_i), m_cos(theta_i), cos_phi);
}
PELAGE_FN Vec4 parity_draw_aggregate_marschner(ScatterAggregate a, Vec4 u) {
  ScatterAggregateChoice c = scatter_choice_aggregate(a);
  ScatterDirection d = scatter_sample_aggregate_marschner(a, c, u);
  return parity_drawn(d, scatter_pdf_aggregate_marschner(a, c, d.sin_i, d.cos_i, d.phi));
}
PELAGE_FN Vec4 parity_draw_aggregate_zhu(ScatterAggregate a, Vec4 u) {
  ScatterAggregateChoice c = scatter_choice_aggregate(a);
  ScatterDirection d = scatter_sample_aggregate_zhu(a, c, u);
  return parity_drawn(d, scatter_pdf_aggregate_zhu(a, c, d.sin_i, d.cos_i, d.phi));
}
PELAGE_FN Vec4 parity_draw_zhu(ScatterLobes l, Vec4 u) {
  ScatterChoice c = scatter_choice_of(l);
  ScatterDirection d = scatter_sample_zhu(l, c, u);
  return parity_drawn(d, scatter_pdf_zhu(l, c, d.sin_i, d.cos_i, d.phi));
}
PELAGE_FN Vec4 parity_draw_kajiya_kay(ScatterLobes l, Vec4 u) {
  ScatterChoice c = scatter_choice_kajiya_kay(l, Vec3(Float(0.5f), Float(0.3f), Float(0.2f)));
  ScatterDirection d = scatter_sample_kajiya_kay(l, c, u);
  return parity_drawn(d, scatter_pdf_kajiya_kay(l, c, d.sin_i, d.cos_i));
}

// Offset h = beta_n - 0.6, inside (-1, 1).
PELAGE_FN ScatterNear parity_near(Float theta_o, Float beta_m, Float beta_n, Float eumelanin, Float eta, Float tilt) {
  return scatter_prepare_chiang(parity_fiber(beta_m, beta_n, eumelanin, eta, tilt), m_sin(theta_o), m_cos(theta_o),
                                beta_n - Float(0.6f));
}
PELAGE_FN ScatterLobes parity_far(Float theta_o, Float beta_m, Float beta_n, Float eumelanin, Float eta, Float tilt) {
  return scatter_prepare_chiang_far(parity_fiber(beta_m, beta_n, eumelanin, eta, tilt), m_sin(theta_o), m_cos(theta_o));
}
PELAGE_FN Vec4 parity_near_energies(ScatterNear n) { return Vec4(n.a_r, n.a_tt.x, n.a_trt.y, n.a_rest.z); }
PELAGE_FN Vec4 parity_near_angles(ScatterNear n) { return Vec4(n.phi_r, n.phi_tt, n.phi_trt, n.rate); }
PELAGE_FN Vec4 parity_draw_chiang(ScatterNear n, Vec4 u) {
  ScatterChoice c = scatter_choice_chiang(n);
  ScatterDirection d = scatter_sample_chiang(n, c, u);
  return parity_drawn(d, scatter_pdf_chiang(n, c, d.sin_i, d.cos_i, d.phi));
}

PELAGE_FN ScatterArtist parity_artist(Float theta_o, Float width, Float around, Float angle, Float shift) {
  ScatterArtistFiber f;
  f.a_r = Vec3(Float(0.1f), Float(0.1f), Float(0.08f));
  f.a_tt = Vec3(Float(0.5f), Float(0.4f), Float(0.3f));
  f.a_trt = Vec3(Float(0.2f), Float(0.2f), Float(0.1f));
  f.a_glint = Vec3(Float(0.1f), Float(0.1f), Float(0.05f));
  f.shift_r = -shift;
  f.shift_tt = shift * Float(0.5f);
  f.shift_trt = shift * Float(1.5f);
  f.width_r = width;
  f.width_tt = width * Float(0.5f);
  f.width_trt = width * Float(2.0f);
  f.around_tt = around;
  f.around_glint = around * Float(0.5f);
  f.glint_angle = angle;
  return scatter_prepare_sadeghi(f, Vec3(Float(0.9f), Float(0.6f), Float(0.3f)), m_sin(theta_o), m_cos(theta_o));
}
PELAGE_FN Vec4 parity_draw_sadeghi(ScatterArtist l, Vec4 u) {
  ScatterChoice c = scatter_choice_sadeghi(l);
  ScatterDirection d = scatter_sample_sadeghi(l, c, u);
  return parity_drawn(d, scatter_pdf_sadeghi(l, c, d.sin_i, d.cos_i, d.phi));
}

PELAGE_FN ScatterPelekis parity_pelekis(Float theta_o, Float beta_m, Float beta_n, Float eumelanin, Float eta, Float tilt) {
  return scatter_prepare_pelekis(parity_fiber(beta_m, beta_n, eumelanin, eta, tilt), m_sin(theta_o), m_cos(theta_o));
}
PELAGE_FN Vec4 parity_pelekis_energies(ScatterPelekis l) { return Vec4(l.a_r, l.a_tt.x, l.a_trt.y, l.a_rest.z); }
PELAGE_FN Vec4 parity_draw_pelekis(ScatterPelekis l, Vec4 u) {
  ScatterChoice c = scatter_choice_pelekis(l);
  ScatterDirection d = scatter_sample_pelekis(l, c, u);
  return parity_drawn(d, scatter_pdf_pelekis(l, c, d.sin_i, d.phi));
}
PELAGE_FN Vec4 parity_glow(ScatterGlow g) { return Vec4(g.energy.x, g.axis.x, g.axis.y, g.alpha + g.even); }
// On maps that are linear in place and level, so that a cell chosen differently at an edge gives the same value.
PELAGE_FN Float parity_probe(Vec3 d, Float alpha) {
  LightProbeCell c = light_probe_cell(d, alpha);
  Float v = Float(0.05f) * c.x - Float(0.02f) * c.y + Float(0.3f) * c.level;
  Float lower = light_probe_mix(c, v, v + Float(0.05f), v - Float(0.02f), v + Float(0.03f));
  return lower * c.sharper + (lower + Float(0.3f)) * (Float(1.0f) - c.sharper);
}
