// What a pixel of deferred software rasterization holds in few bits (Lipp 2026, section 3.1.2), and which pixels its conservative
// layer takes.

// Unit vectors as points of a square, -1 to 1 along each side: the octahedral map (Cigolle 2014).
PELAGE_FN Float raster_sign(Float x) { return select(x < Float(0.0f), Float(-1.0f), Float(1.0f)); }
PELAGE_FN Vec2 raster_octahedral(Vec3 d) {
  Float inverse = Float(1.0f) / max(abs(d.x) + abs(d.y) + abs(d.z), Float(1.0e-30f));
  Float x = d.x * inverse;
  Float y = d.y * inverse;
  Mask below = d.z < Float(0.0f);
  return Vec2(select(below, (Float(1.0f) - abs(y)) * raster_sign(x), x),
              select(below, (Float(1.0f) - abs(x)) * raster_sign(y), y));
}
PELAGE_FN Vec3 raster_from_octahedral(Vec2 p) {
  Float z = Float(1.0f) - abs(p.x) - abs(p.y);
  Float fold = max(Float(0.0f) - z, Float(0.0f));
  return v_normalize(Vec3(p.x - fold * raster_sign(p.x), p.y - fold * raster_sign(p.y), z));
}

// One of 255 levels, so that the middle one is exactly 0; the 256th is left for what is no strand. And back.
const float kRasterTangentLevels = 254.0f;
PELAGE_FN Float raster_tangent_level(Float x) {
  return floor(v_clamp(x * Float(0.5f) + Float(0.5f), Float(0.0f), Float(1.0f)) * Float(kRasterTangentLevels) + Float(0.5f));
}
PELAGE_FN Float raster_tangent_of_level(Float level) { return level * Float(2.0f / kRasterTangentLevels) - Float(1.0f); }
// Radians by which a unit vector may turn on its way there and back (measured by its test over the whole sphere).
const float kRasterTangentMaxError = 0.017f;

// A value of 0 to 1 in one of `count` equal cells; 1 is in the last.
PELAGE_FN Float raster_cell(Float x, Float count) { return v_clamp(floor(x * count), Float(0.0f), count - Float(1.0f)); }

// Depth between the near and the far end of all hair, in 2^24 - 1 equal steps: linear in view space. The 2^24th is for no strand.
const float kRasterDepthLevels = 16777215.0f;
PELAGE_FN Float raster_depth_level(Float z, Float near_end, Float levels_per_metre) {
  return v_clamp(floor((z - near_end) * levels_per_metre), Float(0.0f), Float(kRasterDepthLevels - 1.0f));
}
PELAGE_FN Float raster_depth_of_level(Float level, Float near_end, Float levels_per_metre) {
  return near_end + (level + Float(0.5f)) / levels_per_metre;
}

// First and last row of a column of pixels that a band touches: the lowest and the highest place of its edges between the sides
// of the column, within its ends. Segments are cut across their major axis here, without caps; pixels are half open. Only for
// columns from raster_touched_columns().
PELAGE_FN Vec2 raster_touched_columns(RasterBand r) { return Vec2(floor(min(r.u, r.end_u)), floor(max(r.u, r.end_u))); }
PELAGE_FN Vec2 raster_touched_rows(RasterBand r, Float column) {
  Float from = max(column, min(r.u, r.end_u)) - r.u;
  Float to = min(column + Float(1.0f), max(r.u, r.end_u)) - r.u;
  Float center_from = raster_band_center(r, from);
  Float center_to = raster_band_center(r, to);
  Float half_from = raster_band_half(r, from);
  Float half_to = raster_band_half(r, to);
  return Vec2(floor(min(center_from - half_from, center_to - half_to)),
              floor(max(center_from + half_from, center_to + half_to)));
}
