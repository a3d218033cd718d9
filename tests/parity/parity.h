// Shared by the three targets of the parity test, in the kernel subset: every result becomes four numbers.

const float kParityRounding = 1.0e-6f;  // GLSL may contract a·b + c and divide to within 2.5 ulp: a few roundings
const float kParityPow = 4.0e-6f;       // e^(y·log x): the error of the logarithm grows with y
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
PELAGE_FN Vec4 parity_band_shape(RasterBand r) {
  return Vec4(raster_band_center(r, Float(1.0f)), r.slope, r.first, r.last);
}

PELAGE_FN Vec4 parity_harmonics_low(Vec3 n) {
  LightHarmonics h = light_harmonics(n);
  return Vec4(h.c00, h.c1n, h.c10, h.c1p);
}
PELAGE_FN Vec4 parity_harmonics_high(Vec3 n) {
  LightHarmonics h = light_harmonics(n);
  return Vec4(h.c2nn + h.c2n, h.c20, h.c2p, h.c2pp);
}
