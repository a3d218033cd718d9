// Irradiance of a distant environment in nine spherical harmonics (Ramamoorthi & Hanrahan 2001;
// references.bib: Ramamoorthi2001Irradiance). Real basis, order l m = 00, 1-1, 10, 11, 2-2, 2-1, 20, 21, 22.

struct LightHarmonics {
  Float c00, c1n, c10, c1p, c2nn, c2n, c20, c2p, c2pp;
};

PELAGE_FN LightHarmonics light_harmonics(Vec3 n) {
  LightHarmonics h;
  h.c00 = Float(0.282094792f);
  h.c1n = Float(0.488602512f) * n.y;
  h.c10 = Float(0.488602512f) * n.z;
  h.c1p = Float(0.488602512f) * n.x;
  h.c2nn = Float(1.092548431f) * n.x * n.y;
  h.c2n = Float(1.092548431f) * n.y * n.z;
  h.c20 = Float(0.315391565f) * (Float(3.0f) * n.z * n.z - Float(1.0f));
  h.c2p = Float(1.092548431f) * n.x * n.z;
  h.c2pp = Float(0.546274215f) * (n.x * n.x - n.y * n.y);
  return h;
}

// Weights of the bands l = 0, 1, 2 that turn radiance into irradiance: pi, 2 pi / 3, pi / 4.
const float kLightCosineBand0 = 3.14159265f;
const float kLightCosineBand1 = 2.09439510f;
const float kLightCosineBand2 = 0.785398163f;
