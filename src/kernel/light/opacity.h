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

// Of the strands between a place that the eye sees and a light, expected to be `crossings`, those that would hide the place from the
// eye as well, so that they are not there. Both ways part by `parting` strand widths where the light's has crossed one strand more;
// strands that lie like the one that is seen are on both with a chance that falls linearly to 0 where the ways are a width apart.
PELAGE_FN Float light_shared_crossings(Float crossings, Float parting) {
  Float both = min(crossings, Float(1.0f) / max(parting, Float(1.0e-6f)));
  return both * (Float(1.0f) - Float(0.5f) * parting * both);
}

// Probability that a ray meets no strand where `crossings` are expected: strands at random places (Poisson).
PELAGE_FN Float light_transmittance(Float crossings) { return m_exp(-crossings); }
