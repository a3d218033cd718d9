// Which strand next to an empty pixel is taken to pass through it, and how far a walk along it goes.

// How well a sample fits an empty pixel that lies `offset` pixels from it: 0 ... 1. `tangent` is the strand's unit tangent on
// the screen, without a preferred sign; sigma > 0 in pixels. Huang 2025, eq. 4 (references.bib: Huang2025Linking).
// The way to the pixel, as long as the best score that it can get, is the same for all tangents.
PELAGE_FN Vec2 filter_alignment_axis(Vec2 offset, Float sigma) {
  Float distance2 = dot(offset, offset);
  return offset * (m_exp(Float(-0.5f) * distance2 / (sigma * sigma)) / sqrt(distance2));
}
PELAGE_FN Float filter_alignment(Vec2 offset, Vec2 tangent, Float sigma) {
  return abs(dot(filter_alignment_axis(offset, sigma), tangent));
}

// How much of `alignment` is left for a strand that is `behind` (>= 0) the nearest candidate, both as shares of its distance.
PELAGE_FN Float filter_depth_continuity(Float behind, Float sigma) {
  return m_exp(Float(-0.5f) * behind * behind / (sigma * sigma));
}

// The next step of a walk whose last step moved `pixels` on the screen, so that this one moves one pixel: eq. 7. At most
// kFilterStepGrowth times as far, where the strand is seen nearly end-on.
const float kFilterStepGrowth = 4.0f;
PELAGE_FN Float filter_next_step(Float step, Float pixels) { return step / max(pixels, Float(1.0f / kFilterStepGrowth)); }

// What the weight of a pixel in the orientation-aware filter is made of, each 1/sigma^2 and 0 for a sigma that is infinite.
struct FilterKernel {
  Float inverse_major2, inverse_minor2;                     // of the ellipse, 1/pixels^2
  Float inverse_distance2, inverse_angle2, inverse_color2;  // of Huang 2025, eq. 11, the first with (sigma_d r)^2
  Float half_inverse_along2, half_inverse_across2;          // of Lipp 2026, eq. 9
};

// Whether a pixel `along` the tangent and `across` it belongs to the kernel.
PELAGE_FN Mask filter_inside(FilterKernel k, Float along, Float across) {
  return along * along * k.inverse_major2 + across * across * k.inverse_minor2 <= Float(1.0f);
}

// Minus the exponent of its weight but for color and angle.
PELAGE_FN Float filter_distance_exponent(FilterKernel k, Float along, Float across) {
  Float along2 = along * along;
  Float across2 = across * across;
  return (along2 + across2) * k.inverse_distance2 + along2 * k.half_inverse_along2 + across2 * k.half_inverse_across2;
}

// Angle between the tangent, which has no sign, and the way to the pixel: 0 ... pi/2; 0 for the pixel itself.
PELAGE_FN Float filter_angle(Float along, Float across) { return m_atan2(abs(across), abs(along)); }

PELAGE_FN Float filter_color_exponent(FilterKernel k, Vec3 difference) {
  return dot(difference, difference) * k.inverse_color2;
}
