// What temporal anti-aliasing does to the color that a pixel had before.

// Luma and two chroma differences, with which a box around similar colors is smaller than in RGB; exactly invertible.
// Karis 2014 (references.bib: Karis2014Temporal), after Malvar and Sullivan 2003.
PELAGE_FN Vec3 filter_to_ycocg(Vec3 c) {
  Float sides = Float(0.5f) * (c.x + c.z);
  return Vec3(Float(0.5f) * (c.y + sides), Float(0.5f) * (c.x - c.z), Float(0.5f) * (c.y - sides));
}
PELAGE_FN Vec3 filter_from_ycocg(Vec3 c) {
  Float sides = c.x - c.z;
  return Vec3(sides + c.y, c.x + c.z, sides - c.y);
}

// Share of the way from the middle of a box to a point `offset` from it that is left when the point is pulled to the box:
// 1 inside. `half_size` ≥ 0; a flat box lets nothing stray from it (the 1e-9 keeps 0/0 away).
PELAGE_FN Float filter_clip_share(Vec3 offset, Vec3 half_size) {
  Vec3 over = Vec3(abs(offset.x), abs(offset.y), abs(offset.z)) / (half_size + v_splat(Float(1.0e-9f)));
  return Float(1.0f) / max(Float(1.0f), max(over.x, max(over.y, over.z)));
}
