// Projection of camera-space points; see CameraView (frame/frame.h) for the axes.

// Pixels per metre, facing the camera, at depth z.
PELAGE_FN Float raster_pixel_scale(Mask perspective, Float focal, Float z) { return select(perspective, focal / z, focal); }

// Direction halfway between two segments (dx, dy) of a polyline and their lengths, of no particular length itself:
// d_prev |d_next| + d_next |d_prev| needs no division. Zero where one of them is zero, or they are exactly opposite.
PELAGE_FN Vec2 raster_cap(Vec2 previous, Float previous_length, Vec2 next, Float next_length) {
  return previous * next_length + next * previous_length;
}
