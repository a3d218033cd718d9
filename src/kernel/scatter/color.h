// From what people call a hair's color to its absorption. sigma_a is per fiber radius.

// Absorption of melanin at concentrations as in HairMaterial.
// d'Eon 2011, table 1 (references.bib: dEon2011Energy), after Donner & Jensen 2006.
PELAGE_FN Vec3 scatter_melanin(Float eumelanin, Float pheomelanin) {
  return Vec3(Float(0.419f) * eumelanin + Float(0.187f) * pheomelanin, Float(0.697f) * eumelanin + Float(0.4f) * pheomelanin,
              Float(1.37f) * eumelanin + Float(1.05f) * pheomelanin);
}

// Chiang's azimuthal roughness, 0...1, of a lobe with standard deviation beta_n (radians): Chiang 2016, eq. 8 without its
// 22nd power, inverted (references.bib: Chiang2016Practical); a logistic of scale s has the deviation s pi/sqrt(3).
PELAGE_FN Float scatter_azimuthal_roughness(Float beta_n) {
  Float y = beta_n * Float(0.551328895f) / Float(0.626657069f);
  Float b = (sqrt(Float(0.070225f) + Float(4.776f) * y) - Float(0.265f)) / Float(2.388f);
  return v_clamp(b, Float(0.0f), Float(1.0f));
}
// -sqrt(sigma_a) = log(C)/denominator of a dense tuft of color C: Chiang 2016, eq. 9.
PELAGE_FN Float scatter_color_denominator(Float beta_n) {
  Float b = scatter_azimuthal_roughness(beta_n);
  Float p = Float(0.245f);
  p = p * b + Float(5.574f);
  p = p * b - Float(10.73f);
  p = p * b + Float(2.532f);
  p = p * b - Float(0.215f);
  return p * b + Float(5.969f);
}
// Absorption that gives a dense tuft the color C; channels are clamped to [1e-4, 0.999].
PELAGE_FN Vec3 scatter_absorption(Vec3 color, Float beta_n) {
  Float d = Float(1.0f) / scatter_color_denominator(beta_n);
  Float x = m_log(v_clamp(color.x, Float(1.0e-4f), Float(0.999f))) * d;
  Float y = m_log(v_clamp(color.y, Float(1.0e-4f), Float(0.999f))) * d;
  Float z = m_log(v_clamp(color.z, Float(1.0e-4f), Float(0.999f))) * d;
  return Vec3(x * x, y * y, z * z);
}
// The inverse: color of a dense tuft with absorption sigma_a >= 0.
PELAGE_FN Vec3 scatter_tuft_color(Vec3 sigma_a, Float beta_n) {
  Float d = -scatter_color_denominator(beta_n);
  return Vec3(m_exp(d * sqrt(sigma_a.x)), m_exp(d * sqrt(sigma_a.y)), m_exp(d * sqrt(sigma_a.z)));
}
// What light keeps that crosses one fiber: the mean of e^(-2 sigma_a cos(gamma_t)) over the offset h, with the mean cosine at
// eta = 1.55, 0.925, in the exponent.
const float kCrossingColorMaxAbsError = 1.5e-3f;
PELAGE_FN Vec3 scatter_crossing_color(Vec3 sigma_a) { return v_exp(sigma_a * Float(-1.85f)); }
