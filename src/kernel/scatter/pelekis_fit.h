// Made by tools/fit_pelekis.py: the numbers of pelekis.h, fitted to the mean of Chiang's near field over the fiber.
// Derivation and residuals: docs/derivations/pelekis.md. c = cos(theta_o), u = eta - kPelekisEta, root = 1/eta' (Bravais).

const float kPelekisEta = 1.55f;
const float kPelekisEtaRange = 0.25f;
const float kPelekisMaxRoot = 0.769231f;
const float kPelekisChordTt = 0.165106f;
const float kPelekisChordTrt = 0.211651f;
const float kPelekisChordRest = 0.0485268f;
const float kPelekisBandRise = 0.383857f;
const float kPelekisBandSlope = -4.01268f;
const float kPelekisBandCurve = 10.5089f;
const float kPelekisBandNear = 0.368659f;
const float kPelekisBandFar = 0.706448f;
const float kPelekisForward = 0.0550262f;
const float kPelekisRate = 1.93824f;
const float kPelekisRateFall = 0.243812f;
const float kPelekisRateWide = 0.0057039f;

// Share of the light that enters the fiber.
PELAGE_FN Float scatter_pelekis_enter(Float c, Float u) {
  Float a = (Float(-1.66089f) + Float(2.90677f) * u) + c * (Float(0.496621f) - Float(1.38125f) * u);
  return v_clamp(
      c * ((Float(4.76714f) - Float(1.14642f) * u) + c * a) / (Float(1.0f) + c * (Float(2.89878f) + Float(0.986961f) * u)),
      Float(0.0f), Float(1.0f));
}
// Share of what has entered that leaves as TT, nothing being absorbed.
PELAGE_FN Float scatter_pelekis_leave_tt(Float c, Float u) {
  Float a = (Float(-2.02607f) + Float(4.50289f) * u) + c * (Float(0.674465f) - Float(2.43368f) * u);
  return v_clamp(
      c * ((Float(5.0812f) - Float(0.972498f) * u) + c * a) / (Float(1.0f) + c * (Float(3.01108f) + Float(1.80723f) * u)),
      Float(0.0f), Float(1.0f));
}
// Share of what is left then that leaves as TRT.
PELAGE_FN Float scatter_pelekis_leave_trt(Float c, Float u) {
  Float a = (Float(-2.54498f) + Float(5.17342f) * u) + c * (Float(1.12635f) - Float(2.77136f) * u);
  return v_clamp(
      c * ((Float(5.11351f) - Float(1.09709f) * u) + c * a) / (Float(1.0f) + c * (Float(3.21161f) + Float(1.66563f) * u)),
      Float(0.0f), Float(1.0f));
}
// Mean reflectance inside of what leaves after TRT.
PELAGE_FN Float scatter_pelekis_mirror(Float c) {
  return v_clamp(Float(0.763814f) - Float(0.990222f) * c, Float(0.0f), Float(1.0f));
}
// Shares of N_R that its shoulder and its rim have.
PELAGE_FN Float scatter_pelekis_shoulder(Float c, Float u, Float v_n) {
  Float sharp = (Float(0.0291438f) + Float(0.0436117f) * u) +
                c * ((Float(0.919573f) - Float(0.892602f) * u) + c * (Float(-0.865717f) + Float(0.759709f) * u));
  return v_clamp(sharp + v_n * (Float(-0.203378f) + Float(0.22051f) * c), Float(0.0f), Float(0.5f));
}
PELAGE_FN Float scatter_pelekis_rim(Float c, Float u, Float v_n) {
  Float sharp = (Float(-0.0486908f) + Float(0.0627258f) * u) +
                c * ((Float(0.302712f) - Float(0.271668f) * u) + c * (Float(0.0498313f) - Float(0.275962f) * u));
  return v_clamp(sharp + v_n * (Float(0.178637f) - Float(0.270258f) * c), Float(0.0f), Float(0.5f));
}
// Width^2 and tan^2(mu) of the pairs; v_n: variance of the azimuthal blur, radians^2.
PELAGE_FN Float scatter_pelekis_width2_tt(Float root, Float v_n) {
  Float p = Float(-11.0958f);
  p = p * root + Float(19.7352f);
  p = p * root - Float(12.0618f);
  p = p * root - Float(3.04632f);
  p = p * root + Float(5.09927f);
  return max(p, Float(0.0f)) + (Float(7.31433f) - Float(3.4632f) * root) * v_n;
}
PELAGE_FN Float scatter_pelekis_tan2_tt(Float root, Float v_n) {
  Float p = Float(-0.946571f);
  p = p * root + Float(2.54711f);
  p = p * root - Float(2.17333f);
  p = p * root + Float(0.0427096f);
  p = p * root + Float(0.441841f);
  return max(p, Float(0.0f)) + Float(0.241762f) * v_n;
}
PELAGE_FN Float scatter_pelekis_width2_trt(Float root, Float v_n) {
  Float p = Float(75.8046f);
  p = p * root - Float(85.2611f);
  p = p * root + Float(34.6569f);
  p = p * root - Float(15.6525f);
  p = p * root + Float(5.39516f);
  return max(p, Float(0.0f)) + (Float(7.24165f) - Float(1.97313f) * root) * v_n;
}
PELAGE_FN Float scatter_pelekis_tan2_trt(Float root, Float v_n) {
  Float p = Float(-5.24687f);
  p = p * root + Float(14.3395f);
  p = p * root - Float(9.31477f);
  p = p * root + Float(0.854713f);
  p = p * root + Float(0.425513f);
  return max(p, Float(0.0f)) + Float(0.135548f) * v_n;
}
