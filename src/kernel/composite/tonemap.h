// From scene-linear radiance (Rec. 709 primaries) to what a display expects.

// ACES-like filmic curve: Stephen Hill's rational fit of the ACES 1.0 reference rendering transform followed by the sRGB output
// transform (references.bib: Hill2016Aces). The first matrix takes linear Rec. 709 to AP1 with the transform's
// desaturation, the second goes back; every row sums to one, so neutral stays neutral. 0 becomes 0, plenty becomes 1, and
// negative input counts as 0.
PELAGE_FN Float composite_aces_curve(Float x) {
  Float a = x * (x + Float(0.0245786f)) - Float(0.000090537f);
  Float b = x * (Float(0.983729f) * x + Float(0.4329510f)) + Float(0.238081f);
  return a / b;
}
PELAGE_FN Vec3 composite_tone_map_aces(Vec3 linear) {
  // Above 1e6 the curve is flat to float precision; the limit keeps x² finite.
  Vec3 c = Vec3(v_clamp(linear.x, Float(0.0f), Float(1.0e6f)), v_clamp(linear.y, Float(0.0f), Float(1.0e6f)),
                v_clamp(linear.z, Float(0.0f), Float(1.0e6f)));
  Float r = composite_aces_curve(Float(0.59719f) * c.x + Float(0.35458f) * c.y + Float(0.04823f) * c.z);
  Float g = composite_aces_curve(Float(0.07600f) * c.x + Float(0.90834f) * c.y + Float(0.01566f) * c.z);
  Float b = composite_aces_curve(Float(0.02840f) * c.x + Float(0.13383f) * c.y + Float(0.83777f) * c.z);
  return Vec3(v_clamp(Float(1.60475f) * r - Float(0.53108f) * g - Float(0.07367f) * b, Float(0.0f), Float(1.0f)),
              v_clamp(Float(1.10813f) * g - Float(0.10208f) * r - Float(0.00605f) * b, Float(0.0f), Float(1.0f)),
              v_clamp(Float(1.07602f) * b - Float(0.00327f) * r - Float(0.07276f) * g, Float(0.0f), Float(1.0f)));
}

// sRGB encoding (IEC 61966-2-1) of x clamped to 0…1; absolute error against the exact curve.
const float kSrgbMaxAbsError = 2.0e-6f;
PELAGE_FN Float composite_srgb_encode(Float x) {
  Float c = v_clamp(x, Float(0.0f), Float(1.0f));
  Float low = c * Float(12.92f);
  Float high = Float(1.055f) * m_pow(max(c, Float(0.0031308f)), Float(0.416666667f)) - Float(0.055f);
  return select(c <= Float(0.0031308f), low, high);
}
PELAGE_FN Vec3 composite_srgb_encode3(Vec3 c) {
  return Vec3(composite_srgb_encode(c.x), composite_srgb_encode(c.y), composite_srgb_encode(c.z));
}
