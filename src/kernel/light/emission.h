// What a light sends to a place.

// Share of a spot light's intensity at the cosine c from its axis; smooth between the cosines of its two angles.
PELAGE_FN Float light_spot_share(Float c, Float cos_inner, Float cos_outer) {
  Float t = v_clamp((c - cos_outer) / max(cos_inner - cos_outer, Float(1.0e-6f)), Float(0.0f), Float(1.0f));
  return t * t * (Float(3.0f) - Float(2.0f) * t);
}

// Share of the light's depth test that a receiver at depth z passes: 1 lit, 0 behind `occluder` by more than bias.
PELAGE_FN Float light_depth_test(Float z, Float occluder, Float bias) {
  return select(z - bias > occluder, Float(0.0f), Float(1.0f));
}
