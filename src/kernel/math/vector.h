// Vector helpers of the shared kernel source. dot, cross and + - * come from each target's prelude.

PELAGE_FN Float v_clamp(Float x, Float lo, Float hi) { return min(max(x, lo), hi); }
PELAGE_FN Float v_square(Float x) { return x * x; }
PELAGE_FN Vec3 v_splat(Float s) { return Vec3(s, s, s); }
PELAGE_FN Float v_length(Vec3 a) { return sqrt(dot(a, a)); }
// Unit vector; the zero vector becomes (0, 0, 0).
PELAGE_FN Vec3 v_normalize(Vec3 a) {
  Float l2 = dot(a, a);
  return a * select(l2 > Float(0.0f), Float(1.0f) / sqrt(max(l2, Float(1.0e-38f))), Float(0.0f));
}
PELAGE_FN Vec3 v_positive(Vec3 a) { return Vec3(max(a.x, Float(0.0f)), max(a.y, Float(0.0f)), max(a.z, Float(0.0f))); }
PELAGE_FN Vec3 v_lerp(Vec3 a, Vec3 b, Float t) { return a + (b - a) * t; }
PELAGE_FN Vec3 v_exp(Vec3 a) { return Vec3(m_exp(a.x), m_exp(a.y), m_exp(a.z)); }
PELAGE_FN Float v_luminance(Vec3 c) { return c.x * Float(0.2126f) + c.y * Float(0.7152f) + c.z * Float(0.0722f); }
