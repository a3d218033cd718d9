// Opaque surfaces: Lambert below a GGX coat.

// GGX specular reflection, BRDF times cos(theta_l): Walter et al. 2007 (references.bib: Walter2007Microfacet) with
// Schlick's Fresnel and the height-correlated Smith term. f0: reflectance at normal incidence; alpha: roughness, > 0.
PELAGE_FN Float shade_ggx(Vec3 n, Vec3 to_eye, Vec3 to_light, Float f0, Float alpha) {
  Float nl = dot(n, to_light);
  Float nv = max(dot(n, to_eye), Float(1.0e-3f));
  Vec3 h = v_normalize(to_eye + to_light);
  Float nh = v_clamp(dot(n, h), Float(0.0f), Float(1.0f));
  Float vh = v_clamp(dot(to_eye, h), Float(0.0f), Float(1.0f));
  Float a2 = alpha * alpha;
  Float q = nh * nh * (a2 - Float(1.0f)) + Float(1.0f);
  Float d = a2 / (Float(kPi) * q * q);
  Float cl = max(nl, Float(1.0e-3f));
  Float smith = cl * sqrt(nv * nv * (Float(1.0f) - a2) + a2) + nv * sqrt(cl * cl * (Float(1.0f) - a2) + a2);
  Float m = Float(1.0f) - vh;
  Float m2 = m * m;
  Float f = f0 + (Float(1.0f) - f0) * m2 * m2 * m;
  return select(nl > Float(0.0f), d * f * Float(0.5f) * cl / smith, Float(0.0f));
}
