// Deep opacity maps (Yuksel & Keyser 2008; references.bib: Yuksel2008Opacity).
// A texel stores the strands crossed up to the end of each of its layers, counted from its first strand; between two
// ends the count is linear.

// Layer that holds the depth d behind the first strand (any sign) when its predecessor ends at `begin` and it ends
// at `end`: the share of the layer that lies in front of d, 0 ... 1.
PELAGE_FN Float light_layer_share(Float d, Float begin, Float end) {
  return v_clamp((d - begin) / (end - begin), Float(0.0f), Float(1.0f));
}

// Strands crossed at d: `before` at the layer's beginning, `after` at its end.
PELAGE_FN Float light_crossings(Float d, Float begin, Float end, Float before, Float after) {
  return before + (after - before) * light_layer_share(d, begin, end);
}

// Probability that a ray meets no strand where `crossings` are expected: strands at random places (Poisson).
PELAGE_FN Float light_transmittance(Float crossings) { return m_exp(-crossings); }
