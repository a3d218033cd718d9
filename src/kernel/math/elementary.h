// Elementary functions of the shared kernel source. Own polynomials instead of each platform's library, because then
// scalar C++, every SIMD target and GLSL compute the same thing (the C++ targets: the same bits).
// Coefficients: Cephes single-precision library (Moshier 1989; references.bib: Moshier1989Cephes).
// Error bounds are measured over the stated range by elementary_test.cpp, which reads these very constants.
// The bounds are against the correctly rounded double result.

const float kExpMaxRelError = 2.0e-7f;     // x in [-87, 88]
const float kLogMaxAbsError = 4.0e-7f;     // relative to max(1, |log x|); x positive, normal
const float kSinCosMaxAbsError = 2.0e-7f;  // |x| <= 100
const float kAsinMaxAbsError = 4.0e-7f;    // x in [-1, 1]; also m_acos
const float kAtan2MaxAbsError = 4.0e-7f;   // any x, y but both zero
const float kPowMaxRelError = 5.0e-7f;     // times max(1, |y log x|); x in [1e-6, 1e6], result in [1e-30, 1e30]

const float kPi = 3.14159265358979f;
const float kHalfPi = 1.57079632679490f;
const float kInvPi = 0.318309886183791f;
const float kInvTwoPi = 0.159154943091895f;
const float kTwoPi = 6.28318530717959f;

// e^x; x is clamped to [-87, 88], so the result is always finite and positive.
PELAGE_FN Float m_exp(Float x0) {
  Float x = min(max(x0, Float(-87.0f)), Float(88.0f));
  Float n = floor(x * Float(1.44269504088896f) + Float(0.5f));
  PELAGE_EXACT Float r = (x - n * Float(0.693359375f)) - n * Float(-2.12194440e-4f);
  Float p = Float(1.9875691500e-4f);
  p = p * r + Float(1.3981999507e-3f);
  p = p * r + Float(8.3334519073e-3f);
  p = p * r + Float(4.1665795894e-2f);
  p = p * r + Float(1.6666665459e-1f);
  p = p * r + Float(5.0000001201e-1f);
  return ((p * r) * r + r + Float(1.0f)) * pow2i(n);
}

// Natural logarithm of a positive normal number; smaller arguments are raised to 1.2e-38.
PELAGE_FN Float m_log(Float x0) {
  Float x = max(x0, Float(1.17549435e-38f));
  Float e = exponent_of(x);
  Float m = mantissa_of(x);
  Mask high = m > Float(1.41421356f);
  e = select(high, e + Float(1.0f), e);
  Float r = select(high, m * Float(0.5f), m) - Float(1.0f);
  Float z = r * r;
  Float p = Float(7.0376836292e-2f);
  p = p * r - Float(1.1514610310e-1f);
  p = p * r + Float(1.1676998740e-1f);
  p = p * r - Float(1.2420140846e-1f);
  p = p * r + Float(1.4249322787e-1f);
  p = p * r - Float(1.6668057665e-1f);
  p = p * r + Float(2.0000714765e-1f);
  p = p * r - Float(2.4999993993e-1f);
  p = p * r + Float(3.3333331174e-1f);
  Float y = (p * r) * z + e * Float(-2.12194440e-4f) - z * Float(0.5f);
  return (r + y) + e * Float(0.693359375f);
}

// x^y for x > 0, 0 for x <= 0. Error: kPowMaxRelError, growing with |y log x|.
PELAGE_FN Float m_pow(Float x, Float y) { return select(x > Float(0.0f), m_exp(y * m_log(x)), Float(0.0f)); }

// sin and cos of r in [-pi/4, pi/4].
PELAGE_FN Float m_sin_poly(Float r) {
  Float z = r * r;
  Float p = Float(-1.9515295891e-4f);
  p = p * z + Float(8.3321608736e-3f);
  p = p * z - Float(1.6666654611e-1f);
  return (p * z) * r + r;
}
PELAGE_FN Float m_cos_poly(Float r) {
  Float z = r * r;
  Float p = Float(2.443315711809948e-5f);
  p = p * z - Float(1.388731625493765e-3f);
  p = p * z + Float(4.166664568298827e-2f);
  return (p * z) * z - z * Float(0.5f) + Float(1.0f);
}
// x reduced to [-pi/4, pi/4]; quadrant n mod 4 in 0..3.
PELAGE_FN Float m_quadrant(Float x) { return floor(x * Float(0.636619772367581f) + Float(0.5f)); }
PELAGE_FN Float m_reduce(Float x, Float n) {
  PELAGE_EXACT Float r =
      ((x - n * Float(1.5703125f)) - n * Float(4.837512969970703125e-4f)) - n * Float(7.54978995489188216e-8f);
  return r;
}

PELAGE_FN Float m_sin(Float x) {
  Float n = m_quadrant(x);
  Float r = m_reduce(x, n);
  Float q = n - Float(4.0f) * floor(n * Float(0.25f));
  Mask odd = (q == Float(1.0f)) || (q == Float(3.0f));
  Float v = select(odd, m_cos_poly(r), m_sin_poly(r));
  return select(q >= Float(2.0f), -v, v);
}
PELAGE_FN Float m_cos(Float x) {
  Float n = m_quadrant(x);
  Float r = m_reduce(x, n);
  Float q = n - Float(4.0f) * floor(n * Float(0.25f));
  Mask odd = (q == Float(1.0f)) || (q == Float(3.0f));
  Float v = select(odd, m_sin_poly(r), m_cos_poly(r));
  return select((q == Float(1.0f)) || (q == Float(2.0f)), -v, v);
}

// asin of x clamped to [-1, 1].
PELAGE_FN Float m_asin(Float x) {
  Float a = min(abs(x), Float(1.0f));
  Mask big = a > Float(0.5f);
  Float z = select(big, Float(0.5f) * (Float(1.0f) - a), a * a);
  Float s = select(big, sqrt(z), a);
  Float p = Float(4.2163199048e-2f);
  p = p * z + Float(2.4181311049e-2f);
  p = p * z + Float(4.5470025998e-2f);
  p = p * z + Float(7.4953002686e-2f);
  p = p * z + Float(1.6666752422e-1f);
  Float y = (p * z) * s + s;
  Float v = select(big, Float(kHalfPi) - (y + y), y);
  return select(x < Float(0.0f), -v, v);
}
PELAGE_FN Float m_acos(Float x) { return Float(kHalfPi) - m_asin(x); }

// Angle of (x, y) in [-pi, pi]; 0 where both are zero.
PELAGE_FN Float m_atan2(Float y, Float x) {
  Float ax = abs(x);
  Float ay = abs(y);
  Mask swap = ay > ax;
  Float lo = min(ax, ay);
  Float hi = max(ax, ay);
  Float t = select(hi > Float(0.0f), lo / max(hi, Float(1.0e-38f)), Float(0.0f));
  Mask big = t > Float(0.414213562373095f);
  Float u = select(big, (t - Float(1.0f)) / (t + Float(1.0f)), t);
  Float z = u * u;
  Float p = Float(8.05374449538e-2f);
  p = p * z - Float(1.38776856032e-1f);
  p = p * z + Float(1.99777106478e-1f);
  p = p * z - Float(3.33329491539e-1f);
  Float v = (p * z) * u + u;
  v = select(big, v + Float(0.785398163397448f), v);
  v = select(swap, Float(kHalfPi) - v, v);
  v = select(x < Float(0.0f), Float(kPi) - v, v);
  return select(y < Float(0.0f), -v, v);
}
