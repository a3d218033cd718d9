// Exact areas of a band inside pixels.

// Integral over one pixel column, u from 0 to 1, of clamp(y, 0, 1), where y runs straight from y0 to y1: the part of a
// pixel of lower side 0 below a line. Every difference is of like terms, so flat lines lose no digits.
PELAGE_FN Float raster_area_below(Float y0, Float y1) {
  Float zero = Float(0.0f);
  Float one = Float(1.0f);
  Float lo = min(y0, y1);
  Float hi = max(y0, y1);
  Float inside_lo = min(max(lo, zero), one);
  Float inside_hi = min(max(hi, zero), one);
  Float above = max(hi - max(lo, one), zero);
  Float rise = hi - lo;
  Float whole = above + (inside_hi - inside_lo) * (inside_hi + inside_lo) * Float(0.5f);
  Mask level = rise < Float(1.0e-6f);
  return select(level, inside_lo, whole / select(level, one, rise));
}

// Area of the band inside row v of a part of a column, `share` (0…1) of its width, where neither caps nor ends cut it;
// `center` and `half` in the middle of the part as of raster_band_center(), raster_band_half().
PELAGE_FN Float raster_band_area_part(RasterBand r, Float v, Float center, Float half, Float share) {
  Float middle = center - v + Float(0.5f);
  Float rise_low = (r.slope - r.half_slope) * share * Float(0.5f);
  Float rise_high = (r.slope + r.half_slope) * share * Float(0.5f);
  Float low = middle - half;
  Float high = middle + half;
  return share * max(raster_area_below(high - rise_high, high + rise_high) - raster_area_below(low - rise_low, low + rise_low),
                     Float(0.0f));
}

// The same for a whole column, whose center is u.
PELAGE_FN Float raster_band_area(RasterBand r, Float v, Float center, Float half) {
  return raster_band_area_part(r, v, center, half, Float(1.0f));
}
