// What the operators of a hair mesh's style do at one control point (StyleOperator in <pelage/hair_mesh.h> has the ranges).
// w: place along the cage, 0 at the root. Shifts are in the strand's frame, x along its normal and y along its binormal,
// of length 1 at most; phases and frequencies count whole turns.

// Waves of noise along a strand, as a share of its frequency: the mean of its three.
const float kStyleNoiseTurns = 0.7f;

// Share of the strand over which an operator gains its full strength.
const float kStyleOnset = 0.25f;

PELAGE_FN Float style_smooth(Float t) {
  Float s = v_clamp(t, Float(0.0f), Float(1.0f));
  return s * s * (Float(3.0f) - Float(2.0f) * s);
}
PELAGE_FN Float style_onset(Float w, Float start) { return style_smooth((w - start) * Float(1.0f / kStyleOnset)); }
// Of operators that grow up to the tip.
PELAGE_FN Float style_growth(Float w, Float start) {
  return style_smooth((w - start) / max(Float(1.0f) - start, Float(1.0e-3f)));
}

// Radians of a number of turns, without those that are whole: large arguments would cost digits.
PELAGE_FN Float style_angle(Float turns) { return (turns - floor(turns)) * Float(6.283185307179586f); }

// Where a point of a curve has to stand for the polyline through such points to lie on both sides of it: moved against the second
// difference by what chords lie inside of it on average, h² |p″| / 12 for points h apart. A wave keeps its amplitude: that is the
// start of 1 / sinc².
PELAGE_FN Vec3 style_chord_point(Vec3 before, Vec3 here, Vec3 behind) {
  return here - (before + behind - here * Float(2.0f)) * Float(1.0f / 12.0f);
}

PELAGE_FN Float style_wave(Float w, Float frequency, Float phase) {
  PELAGE_EXACT Float turns = w * frequency + phase;
  return m_sin(style_angle(turns));
}
PELAGE_FN Vec2 style_curl(Float w, Float frequency, Float phase) {
  PELAGE_EXACT Float turns = w * frequency + phase;
  Float angle = style_angle(turns);
  return Vec2(m_cos(angle), m_sin(angle));
}

// Three plane waves across the groom, in directions that fall into no pattern.
PELAGE_FN Vec2 style_noise(Vec3 uvw, Float frequency, Float phase) {
  PELAGE_EXACT Float along_a = uvw.x * Float(0.82f) + uvw.y * Float(0.39f) + uvw.z * Float(0.42f);
  PELAGE_EXACT Float along_b = uvw.y * Float(0.71f) + uvw.z * Float(0.61f) - uvw.x * Float(0.53f);
  PELAGE_EXACT Float along_c = uvw.x * Float(0.31f) + uvw.z * Float(0.97f) - uvw.y * Float(0.88f);
  PELAGE_EXACT Float turns_a = along_a * frequency + phase;
  PELAGE_EXACT Float turns_b = along_b * frequency + phase + Float(0.37f);
  PELAGE_EXACT Float turns_c = along_c * frequency + phase + Float(0.71f);
  Float a = style_angle(turns_a);
  Float b = style_angle(turns_b);
  Float c = style_angle(turns_c);
  Float third = Float(1.0f / 3.0f);
  return Vec2((m_sin(a) + m_sin(b) + m_sin(c)) * third, (m_cos(a) + m_cos(b) + m_cos(c)) * third);
}

// Waves along one strand, of three frequencies whose ratios are far from whole numbers. phase: three of its own.
PELAGE_FN Vec2 style_frizz(Float w, Float frequency, Vec3 phase) {
  PELAGE_EXACT Float turns_a = w * frequency + phase.x;
  PELAGE_EXACT Float turns_b = w * frequency * Float(1.71f) + phase.y;
  PELAGE_EXACT Float turns_c = w * frequency * Float(0.59f) + phase.z;
  Float a = style_angle(turns_a);
  Float b = style_angle(turns_b);
  Float c = style_angle(turns_c);
  return Vec2(Float(0.4f) * m_sin(a) + Float(0.3f) * m_sin(b), Float(0.4f) * m_cos(c) + Float(0.3f) * m_cos(b));
}

// Place in the bundle, drawn to the middle of a clump.
PELAGE_FN Vec2 style_clump(Vec2 uv, Vec2 middle, Float share) { return uv + (middle - uv) * share; }

// The third of the bundle, 0, 1 or 2, that goes into one lock of a braid, by u.
PELAGE_FN Float style_braid_lock(Float u) { return min(floor(u * Float(3.0f)), Float(2.0f)); }
// Place in the bundle within a braid: each lock runs a figure of eight, a third of a turn behind the one before it, and has
// `thickness` of the bundle for itself. share: how far the braid is closed.
PELAGE_FN Vec2 style_braid(Vec2 uv, Float w, Float frequency, Float thickness, Float share) {
  Float lock = style_braid_lock(uv.x);
  PELAGE_EXACT Float turns = w * frequency + lock * Float(1.0f / 3.0f);
  Float angle = style_angle(turns);
  Vec2 middle = Vec2(Float(0.5f) + Float(0.32f) * m_sin(angle), Float(0.5f) + Float(0.2f) * m_sin(angle + angle));
  Vec2 within = Vec2((uv.x * Float(3.0f) - lock - Float(0.5f)) * thickness, (uv.y - Float(0.5f)) * thickness);
  return style_clump(uv, middle + within, share);
}

// Width as a share of that at the root.
PELAGE_FN Float style_taper(Float w, Float start, Float tip) {
  return Float(1.0f) + (tip - Float(1.0f)) * style_growth(w, start);
}
