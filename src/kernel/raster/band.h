// The band of a strand on the screen: which points it covers, and how deep it is there. Every layer of raster (center,
// samples, conservative, analytic, overdraw), fast or plain, means this one definition; derivation and bounds stand
// in docs/derivations/raster.md.
//
// A segment runs from point a to point b (pixels). Its major axis is the one along which it is longer, ties go to x.
// With u along the major and v along the minor axis, s = u - a.u, and the slope m = dv/du of the segment, |m| <= 1:
//
//   center line   v(s) = a.v + m s
//   half height   h(s) = sqrt(1 + m^2) (a.r + (b.r - a.r) s / du)      perpendicular distance r = height / sqrt(1 + m^2)
//
// The band is the set of points with
//   (1) |v - v(s)| <= h(s)                                             between two straight lateral edges
//   (2) cap_a . (p - a) >= 0  and  cap_b . (p - b) < 0                 between its two caps
//   (3) min(a.u - e_a, b.u - e_b) <= u <= max(a.u + e_a, b.u + e_b)    e = kRasterMiterLimit r
// The cap of a point is the line through it across cap_x, cap_y, the direction halfway between the strand's two
// segments there (its normal is the miter). Both neighbors evaluate the very same expression, one with >=, the other
// with <: along a strand nothing is covered twice or left open. Both lateral edges stand at distance r from their
// center lines, so they meet on the miter. (3) bevels the miter of a sharp bend (up to 90 degrees it is whole).
//
// Depth is linear along u, within the depths of the two ends. A segment seen end-on (a = b) covers nothing.

const float kRasterMiterLimit = 1.5f;

struct RasterBand {
  Mask x_major;  // u is x, v is y; otherwise u is y, v is x
  Float u, v;    // start a
  Float slope;   // m
  Float half, half_slope;
  Float depth, depth_slope, depth_min, depth_max;
  Float first, last;   // rule (3)
  Vec2 cap_a, cap_b;   // in (u, v)
  Float end_u, end_v;  // end b
};

PELAGE_FN RasterBand raster_band(Vec2 a, Vec2 b, Float radius_a, Float radius_b, Float depth_a, Float depth_b, Vec2 cap_a,
                                 Vec2 cap_b) {
  RasterBand r;
  Float dx = b.x - a.x;
  Float dy = b.y - a.y;
  r.x_major = abs(dx) >= abs(dy);
  Float du = select(r.x_major, dx, dy);
  Float dv = select(r.x_major, dy, dx);
  Float inverse = select(abs(du) > Float(0.0f), Float(1.0f) / du, Float(0.0f));
  r.u = select(r.x_major, a.x, a.y);
  r.v = select(r.x_major, a.y, a.x);
  r.end_u = select(r.x_major, b.x, b.y);
  r.end_v = select(r.x_major, b.y, b.x);
  r.cap_a = Vec2(select(r.x_major, cap_a.x, cap_a.y), select(r.x_major, cap_a.y, cap_a.x));
  r.cap_b = Vec2(select(r.x_major, cap_b.x, cap_b.y), select(r.x_major, cap_b.y, cap_b.x));
  r.slope = dv * inverse;
  Float stretch = sqrt(Float(1.0f) + r.slope * r.slope);
  r.half = radius_a * stretch;
  r.half_slope = (radius_b - radius_a) * stretch * inverse;
  r.depth = depth_a;
  r.depth_slope = (depth_b - depth_a) * inverse;
  r.depth_min = min(depth_a, depth_b);
  r.depth_max = max(depth_a, depth_b);
  Float reach_a = radius_a * Float(kRasterMiterLimit);
  Float reach_b = radius_b * Float(kRasterMiterLimit);
  r.first = min(r.u - reach_a, r.end_u - reach_b);
  r.last = max(r.u + reach_a, r.end_u + reach_b);
  return r;
}

PELAGE_FN Float raster_band_center(RasterBand r, Float s) { return r.v + s * r.slope; }
PELAGE_FN Float raster_band_half(RasterBand r, Float s) { return r.half + s * r.half_slope; }
PELAGE_FN Float raster_band_depth(RasterBand r, Float s) {
  return min(max(r.depth + s * r.depth_slope, r.depth_min), r.depth_max);
}
// Side of (u, v) on the cap of point (cap_u, cap_v): positive towards the strand's tip.
PELAGE_FN Float raster_cap_side(Vec2 cap, Float u, Float v, Float cap_u, Float cap_v) {
  return cap.x * (u - cap_u) + cap.y * (v - cap_v);
}
// Rule (2) at (u, v).
PELAGE_FN Mask raster_between_caps(RasterBand r, Float u, Float v) {
  Float side_a = raster_cap_side(r.cap_a, u, v, r.u, r.v);
  Float side_b = raster_cap_side(r.cap_b, u, v, r.end_u, r.end_v);
  return (side_a >= Float(0.0f)) && (side_b < Float(0.0f));
}

// Candidates of rule (1) for points at offset `at` (0.5 for pixel centers) in column s: rows j from this one on, as long
// as raster_row_covered. Fast and plain rasterizers share these two expressions, hence the very same pixels.
PELAGE_FN Float raster_first_row(Float center, Float half, Float at) { return ceil((center - half) - at); }
PELAGE_FN Mask raster_row_covered(Float row, Float at, Float center, Float half) { return (row + at) - center <= half; }

// Samples of one pixel share its depth, and c(s) and h(s) of its center's column; a sample off by (o_u, o_v) from there is
// covered where
//   |((row + 1/2) - c(s)) + (o_v - m o_u)| <= h(s) + dh/du o_u.
// The brackets with o_u are the same for all pixels of a segment: `shift` and `growth`.
PELAGE_FN Float raster_sample_shift(RasterBand r, Float o_u, Float o_v) { return o_v - r.slope * o_u; }
PELAGE_FN Float raster_sample_growth(RasterBand r, Float o_u) { return r.half_slope * o_u; }
PELAGE_FN Mask raster_sample_covered(Float above_center, Float shift, Float half, Float growth) {
  return abs(above_center + shift) <= half + growth;
}
// Rows of a pixel column whose pixels lie within the lateral edges, if only in part: from here ...
PELAGE_FN Float raster_lowest_row(RasterBand r, Float center, Float half) {
  return floor(center - (half + abs(r.slope - r.half_slope) * Float(0.5f)));
}
// ... to here.
PELAGE_FN Float raster_highest_row(RasterBand r, Float center, Float half) {
  return floor(center + (half + abs(r.slope + r.half_slope) * Float(0.5f)));
}
// Rule (2) of a sample, from the sides of its pixel's center and what its offset adds to them, and rule (3) at u.
PELAGE_FN Float raster_cap_shift(Vec2 cap, Float o_u, Float o_v) { return cap.x * o_u + cap.y * o_v; }
PELAGE_FN Mask raster_past_cap(Float side, Float shift) { return side + shift >= Float(0.0f); }
PELAGE_FN Mask raster_before_cap(Float side, Float shift) { return side + shift < Float(0.0f); }
PELAGE_FN Mask raster_between_ends(RasterBand r, Float u) { return (u >= r.first) && (u <= r.last); }
// Both rules of a sample.
PELAGE_FN Mask raster_sample_between_caps(RasterBand r, Float side_a, Float side_b, Float u, Float o_u, Float o_v) {
  return raster_past_cap(side_a, raster_cap_shift(r.cap_a, o_u, o_v)) &&
         raster_before_cap(side_b, raster_cap_shift(r.cap_b, o_u, o_v)) && raster_between_ends(r, u + o_u);
}
// Whether the whole pixel around (u, v) keeps rules (2) and (3), with a margin for roundings.
PELAGE_FN Mask raster_pixel_between_caps(RasterBand r, Float side_a, Float side_b, Float u) {
  Float reach_a = (abs(r.cap_a.x) + abs(r.cap_a.y)) * Float(0.51f);
  Float reach_b = (abs(r.cap_b.x) + abs(r.cap_b.y)) * Float(0.51f);
  return (side_a >= reach_a) && (side_b < Float(0.0f) - reach_b) && (u - Float(0.51f) >= r.first) &&
         (u + Float(0.51f) <= r.last);
}
// Columns of pixels, as (lowest, highest) number, in which caps and ends cut nothing off the band. A covered point at s along
// the band is off its center line by at most H, the larger of the two half heights; it is past the cap c of point a where
// (c.x + m c.y) s >= |c.y| H, and likewise before that of b. 0.02 pixels are for roundings. Empty where a cap points backwards.
PELAGE_FN Float raster_cap_reach(Vec2 cap, Float slope, Float du, Float half) {
  Float along = select(du > Float(0.0f), cap.x + slope * cap.y, Float(0.0f) - (cap.x + slope * cap.y));
  Float needed = abs(cap.y) * half + (abs(cap.x) + abs(cap.y)) * Float(0.02f);
  return select(along > Float(0.0f), needed / along, Float(1.0e9f));
}
PELAGE_FN Vec2 raster_uncut_columns(RasterBand r) {
  Float du = r.end_u - r.u;
  Float half = max(r.half, raster_band_half(r, du));
  Float reach_a = raster_cap_reach(r.cap_a, r.slope, du, half);
  Float reach_b = raster_cap_reach(r.cap_b, r.slope, du, half);
  Float from = select(du > Float(0.0f), r.u + reach_a, r.end_u + reach_b);
  Float to = select(du > Float(0.0f), r.end_u - reach_b, r.u - reach_a);
  return Vec2(ceil(from), floor(to) - Float(1.0f));
}
