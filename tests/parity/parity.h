// Shared by the three targets of the parity test, in the kernel subset: every result becomes four numbers.

const float kParityRounding = 1.0e-6f;  // GLSL may contract a·b + c and divide to within 2.5 ulp: a few roundings
const float kParityPow = 4.0e-6f;       // e^(y·log x): the error of the logarithm grows with y

PELAGE_FN Vec4 parity_result(Float x) { return Vec4(x, Float(0.0f), Float(0.0f), Float(0.0f)); }
PELAGE_FN Vec4 parity_result(Vec2 v) { return Vec4(v.x, v.y, Float(0.0f), Float(0.0f)); }
PELAGE_FN Vec4 parity_result(Vec3 v) { return Vec4(v.x, v.y, v.z, Float(0.0f)); }
PELAGE_FN Vec4 parity_result(Vec4 v) { return v; }
PELAGE_FN Vec4 parity_result(Mask m) { return parity_result(select(m, Float(1.0f), Float(0.0f))); }
