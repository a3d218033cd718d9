// Cubic Hermite spans as polynomials: p(t) = c0 + c1 t + c2 t^2 + c3 t^3 from p0 to p1 with derivatives m0 and m1.

PELAGE_FN Float curve_hermite_c2(Float p0, Float m0, Float p1, Float m1) { return Float(3.0f) * (p1 - p0) - (m0 + m0 + m1); }
PELAGE_FN Float curve_hermite_c3(Float p0, Float m0, Float p1, Float m1) { return m0 + m1 - Float(2.0f) * (p1 - p0); }

PELAGE_FN Vec3 curve_cubic(Vec3 c0, Vec3 c1, Vec3 c2, Vec3 c3, Float t) { return c0 + (c1 + (c2 + c3 * t) * t) * t; }
PELAGE_FN Vec3 curve_cubic_derivative(Vec3 c1, Vec3 c2, Vec3 c3, Float t) {
  return c1 + (c2 * Float(2.0f) + c3 * (Float(3.0f) * t)) * t;
}
// The same for a parameter beyond the span: straight on from its end (Lipp 2026, A.1).
PELAGE_FN Vec3 curve_cubic_onward(Vec3 c0, Vec3 c1, Vec3 c2, Vec3 c3, Float t) {
  Float inside = v_clamp(t, Float(0.0f), Float(1.0f));
  return curve_cubic(c0, c1, c2, c3, inside) + curve_cubic_derivative(c1, c2, c3, inside) * (t - inside);
}
