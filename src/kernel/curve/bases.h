// Curve bases: weights of the four control points p0..p3 of a span at parameter t in [0, 1], and their derivatives
// with respect to t. A span runs from p1 to p2 (Catmull-Rom: through them; uniform B-spline: near them; Bezier: from
// p0 to p3; linear: p1 to p2).
// Catmull & Rom 1974 (uniform, tension 1/2); references.bib: Catmull1974Splines, deBoor1978Splines.

PELAGE_FN Vec4 curve_linear_weights(Float t) { return Vec4(Float(0.0f), Float(1.0f) - t, t, Float(0.0f)); }
PELAGE_FN Vec4 curve_linear_derivative(Float t) {
  return Vec4(Float(0.0f), Float(-1.0f) + t * Float(0.0f), Float(1.0f), Float(0.0f));
}

// clang-format off: a line a control point
PELAGE_FN Vec4 curve_catmull_rom_weights(Float t) {
  Float s = Float(1.0f) - t;
  return Vec4(Float(-0.5f) * t * s * s, Float(1.0f) + t * t * (Float(1.5f) * t - Float(2.5f)),
              Float(1.0f) + s * s * (Float(1.5f) * s - Float(2.5f)), Float(-0.5f) * s * t * t);
}
PELAGE_FN Vec4 curve_catmull_rom_derivative(Float t) {
  return Vec4(Float(-0.5f) + t * (Float(2.0f) - Float(1.5f) * t), t * (Float(4.5f) * t - Float(5.0f)),
              Float(0.5f) + t * (Float(4.0f) - Float(4.5f) * t), t * (Float(1.5f) * t - Float(1.0f)));
}

PELAGE_FN Vec4 curve_bspline_weights(Float t) {
  Float s = Float(1.0f) - t;
  Float sixth = Float(0.166666666666667f);
  return Vec4(sixth * s * s * s, sixth * (Float(4.0f) + t * t * (Float(3.0f) * t - Float(6.0f))),
              sixth * (Float(4.0f) + s * s * (Float(3.0f) * s - Float(6.0f))), sixth * t * t * t);
}
PELAGE_FN Vec4 curve_bspline_derivative(Float t) {
  Float s = Float(1.0f) - t;
  return Vec4(Float(-0.5f) * s * s, t * (Float(1.5f) * t - Float(2.0f)), Float(-1.0f) * s * (Float(1.5f) * s - Float(2.0f)),
              Float(0.5f) * t * t);
}
// clang-format on

PELAGE_FN Vec4 curve_bezier_weights(Float t) {
  Float s = Float(1.0f) - t;
  return Vec4(s * s * s, Float(3.0f) * s * s * t, Float(3.0f) * s * t * t, t * t * t);
}
PELAGE_FN Vec4 curve_bezier_derivative(Float t) {
  Float s = Float(1.0f) - t;
  return Vec4(Float(-3.0f) * s * s, Float(3.0f) * s * (s - Float(2.0f) * t), Float(3.0f) * t * (Float(2.0f) * s - t),
              Float(3.0f) * t * t);
}

PELAGE_FN Vec3 curve_combine(Vec4 w, Vec3 p0, Vec3 p1, Vec3 p2, Vec3 p3) { return p0 * w.x + p1 * w.y + p2 * w.z + p3 * w.w; }
