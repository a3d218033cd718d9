// A prefiltered environment: maps over directions, each blurred by a GGX lobe of one roughness. docs/derivations/probe.md.

const float kProbeLevels = 6.0f;
const float kProbeSharpest = 2.23606798f;  // 1/sqrt(alpha) of level 0, alpha = 0.2; falls evenly to 1
const float kProbeSide = 48.0f;            // texels a side, without the frame of one texel around them
const float kProbeMaxRelError = 0.05f;     // of a look-up, over the brightest there is of its roughness; alpha >= 0.2

PELAGE_FN Float light_probe_alpha(Float level) {
  Float x = Float(kProbeSharpest) - level * Float((kProbeSharpest - 1.0f) / (kProbeLevels - 1.0f));
  return Float(1.0f) / (x * x);
}
PELAGE_FN Float light_probe_level(Float alpha) {
  Float x = Float(1.0f) / sqrt(max(alpha, Float(1.0e-3f)));
  Float level = (Float(kProbeSharpest) - x) * Float((kProbeLevels - 1.0f) / (kProbeSharpest - 1.0f));
  return v_clamp(level, Float(0.0f), Float(kProbeLevels - 1.0f));
}

// Directions to the square [0, 1]^2, by raster_octahedral().
PELAGE_FN Vec2 light_octahedral(Vec3 d) {
  Vec2 p = raster_octahedral(d);
  return Vec2(Float(0.5f) + Float(0.5f) * p.x, Float(0.5f) + Float(0.5f) * p.y);
}
// The direction of a place, of unit length; places less than one beyond an edge are those that lie there on the octahedron:
// every edge is glued to itself, turned around its middle.
PELAGE_FN Vec3 light_octahedral_direction(Vec2 place) {
  Float x = place.x + place.x - Float(1.0f);
  Float y = place.y + place.y - Float(1.0f);
  Mask out_x = abs(x) > Float(1.0f);
  Float u = select(out_x, Float(2.0f) * raster_sign(x) - x, x);
  Float v = select(out_x, -y, y);
  Mask out_y = abs(v) > Float(1.0f);
  return raster_from_octahedral(Vec2(select(out_y, -u, u), select(out_y, Float(2.0f) * raster_sign(v) - v, v)));
}

// What a prefiltered map weighs light with, up to a factor: D(h) cos with normal, view and axis alike (Walter 2007;
// references.bib: Walter2007Microfacet). `cosine` from the axis.
PELAGE_FN Float light_ggx_lobe(Float alpha, Float cosine) {
  Float a2 = alpha * alpha;
  Float d = Float(1.0f) - (Float(1.0f) - a2) * (Float(0.5f) + Float(0.5f) * cosine);
  return a2 * max(cosine, Float(0.0f)) / (d * d);
}

// Where to look: four texels of two levels, in planes of (kProbeSide + 2)^2 texels.
struct LightProbeCell {
  Float level;    // the lower one
  Float sharper;  // weight of the lower one
  Float x;        // of the upper left texel
  Float y;
  Float right;  // weight of the right texels
  Float lower;
};
PELAGE_FN LightProbeCell light_probe_cell(Vec3 d, Float alpha) {
  Vec2 place = light_octahedral(d);
  Float x = place.x * Float(kProbeSide) + Float(0.5f);  // the frame's texels have the centers -0.5 and kProbeSide + 0.5
  Float y = place.y * Float(kProbeSide) + Float(0.5f);
  Float k = light_probe_level(alpha);
  LightProbeCell c;
  c.level = min(floor(k), Float(kProbeLevels - 2.0f));
  c.sharper = Float(1.0f) - (k - c.level);
  c.x = v_clamp(floor(x), Float(0.0f), Float(kProbeSide));
  c.y = v_clamp(floor(y), Float(0.0f), Float(kProbeSide));
  c.right = x - c.x;
  c.lower = y - c.y;
  return c;
}
PELAGE_FN Float light_probe_mix(LightProbeCell c, Float v00, Float v01, Float v10, Float v11) {
  Float a = v00 + (v01 - v00) * c.right;
  Float b = v10 + (v11 - v10) * c.right;
  return a + (b - a) * c.lower;
}
