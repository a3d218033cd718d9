// Level of detail of a bundle of hair: Lipp 2026 (references.bib: Lipp2026Deferred).

// Eq. 2: L, by the diagonal of the bundle's box on the screen (pixels) over the rows of the picture.
PELAGE_FN Float lod_selection(Vec2 box_min, Vec2 box_max, Float rows, Float lambda) {
  Vec2 d = box_max - box_min;
  return v_clamp(sqrt(d.x * d.x + d.y * d.y) / rows * lambda, Float(0.0f), Float(1.0f));
}
// Eq. 1: strands of N; delta, 0 to 1, is the bundle's own.
PELAGE_FN Float lod_strands(Float selection, Float strands, Float delta) {
  return v_clamp(ceil(selection * (strands + delta)), Float(1.0f), strands);
}
// Eq. 4 and 5: control points of a strand, 2^k + 1 of them, or `most`.
PELAGE_FN Float lod_points(Float selection, Float most, Float layers) {
  Float raw = max(max(floor(sqrt(selection) * most), layers), Float(3.0f));
  Float intervals = raw - Float(1.0f);
  Float power = pow2i(exponent_of(intervals));
  return min(select(power < intervals, power + power, power) + Float(1.0f), most);
}
// The widest that strands become, over the width of their bundle. Wider ones fill the gaps between locks, and hair that is seen
// less deep is brighter: by 1.5 % at 0.035, by 8 % at 0.085 (long hair of 20 pixels by eq. 1 alone).
const float kLodWidestStrand = 0.03f;
// Strands below which eq. 1 does not go: those that have the width of all when each is that wide.
PELAGE_FN Float lod_least_strands(Float strands, Float width, Float bundle_width) {
  return v_clamp(ceil(strands * width / (bundle_width * Float(kLodWidestStrand))), Float(1.0f), strands);
}
// Eq. 8: how much optical depth strands lose as some of them are left out; share: of the width that is left, 0 to 1.
PELAGE_FN Float lod_depth_shift(Float share) { return Float(0.0f) - m_log(max(share, Float(1.0e-6f))); }
