// Control points of a group of strands, written once for one lane and for many.
//
// Included inside a namespace that has Float, Int, Vec3, Mask, the kernels and the lane access of kernel/lanes*.h, with
// PELAGE_LANES_FN defined. What differs between bundles is uniform over the lanes and may branch. No include guard, on purpose.

// A place on the cage: span, and how far along it.
struct CagePlace {
  Float span;   // whole number
  Float t;      // in the span; beyond 1 past the cage's end
  int uniform;  // the span of all lanes of the group; −1 where they differ
};

// The style of a bundle, with what its operators change.
struct StrandStyle {
  const StyleOperator *clump, *braid, *wave, *curl, *noise, *frizz, *taper;
  bool moves_across;  // within the bundle, along the strand
  bool shifts;        // off the base strand
};

PELAGE_LANES_FN StrandStyle strand_style(const BundleCage& cage) {
  using Kind = StyleOperator::Kind;
  StrandStyle s;
  s.clump = cage.find(Kind::kClump), s.braid = cage.find(Kind::kBraid), s.wave = cage.find(Kind::kWave);
  s.curl = cage.find(Kind::kCurl), s.noise = cage.find(Kind::kNoise), s.frizz = cage.find(Kind::kFrizz);
  s.taper = cage.find(Kind::kTaper);
  s.moves_across = s.clump || s.braid;
  s.shifts = s.wave || s.curl || s.noise || s.frizz;
  return s;
}

// Polynomial of a strand's base in one span.
struct StrandCubic {
  Vec3 c[4];
};

PELAGE_LANES_FN Float strand_blend(const Float (&weight)[4], const Float (&corner)[4]) {
  return weight[0] * corner[0] + weight[1] * corner[1] + weight[2] * corner[2] + weight[3] * corner[3];
}

PELAGE_LANES_FN void strand_weights(Float u, Float v, Float (&weight)[4]) {
  const Float one(1.0f), left = one - u, low = one - v;
  weight[0] = left * low, weight[1] = u * low, weight[2] = u * v, weight[3] = left * v;
}

// Values of the four columns: `stride` floats apart, `offset` into the record of the lane's span.
PELAGE_LANES_FN Float strand_across(const float* values, std::size_t record, std::size_t stride, std::size_t offset,
                                    const CagePlace& at, const Float (&weight)[4]) {
  Float corner[4];
  if (at.uniform >= 0) {
    const float* here = values + static_cast<std::size_t>(at.uniform) * record + offset;
    for (std::size_t c = 0; c < 4; ++c) corner[c] = Float(here[c * stride]);
  } else {
    const Int here = to_int(at.span) * Int(static_cast<std::int32_t>(record));
    for (std::size_t c = 0; c < 4; ++c) corner[c] = gather(values + offset + c * stride, here);
  }
  return strand_blend(weight, corner);
}

PELAGE_LANES_FN StrandCubic strand_cubic(const BundleCage& cage, const CagePlace& at, const Float (&weight)[4]) {
  StrandCubic cubic;
  const auto coefficient = [&](std::size_t i) {
    return strand_across(cage.coefficients.data(), BundleCage::kSpan, BundleCage::kCoefficients, i, at, weight);
  };
  for (std::size_t k = 0; k < 4; ++k) cubic.c[k] = Vec3(coefficient(3 * k), coefficient(3 * k + 1), coefficient(3 * k + 2));
  return cubic;
}

// Between the values of the layers around a place.
PELAGE_LANES_FN Float strand_occlusion(const BundleCage& cage, const CagePlace& at, const Float (&weight)[4]) {
  const Float from = strand_across(cage.occlusion.data(), 4, 1, 0, at, weight);
  const Float to = strand_across(cage.occlusion.data(), 4, 1, 4, at, weight);
  return from + (to - from) * min(at.t, Float(1.0f));
}

PELAGE_LANES_FN Vec3 strand_normal(const BundleCage& cage, const CagePlace& at) {
  const auto component = [&](std::size_t i) {
    const float* n = cage.normals.data() + i;
    Float from, to;
    if (at.uniform >= 0) {
      const std::size_t k = static_cast<std::size_t>(at.uniform) * 3;
      from = Float(n[k]), to = Float(n[k + 3]);
    } else {
      const Int k = to_int(at.span) * Int(3);
      from = gather(n, k), to = gather(n + 3, k);
    }
    return from + (to - from) * min(at.t, Float(1.0f));
  };
  return Vec3(component(0), component(1), component(2));
}

// Where in the bundle lane group `l` runs at w.
PELAGE_LANES_FN Vec2 strand_across_at(const StrandStyle& style, const StrandTraits& t, std::size_t l, Float w) {
  Vec2 uv(load(&t.u[l]), load(&t.v[l]));
  if (style.clump)
    uv = style_clump(uv, Vec2(load(&t.clump_u[l]), load(&t.clump_v[l])),
                     load(&t.clump[l]) * style_growth(w, Float(style.clump->start)));
  if (style.braid)
    uv = style_braid(uv, w, Float(style.braid->frequency), load(&t.braid[l]), style_onset(w, Float(style.braid->start)));
  return uv;
}

// Shift off the base strand, along its normal and its binormal, metres.
PELAGE_LANES_FN Vec2 strand_shift(const StrandStyle& style, const StrandTraits& t, std::size_t l, Float w) {
  Vec2 shift(Float(0.0f), Float(0.0f));
  if (const StyleOperator* o = style.wave) {
    const Float swing = style_onset(w, Float(o->start)) * style_wave(w, Float(o->frequency), load(&t.wave_phase[l]));
    shift = shift + Vec2(load(&t.wave_x[l]), load(&t.wave_y[l])) * swing;
  }
  if (const StyleOperator* o = style.curl)
    shift = shift +
            style_curl(w, Float(o->frequency), load(&t.curl_phase[l])) * (Float(o->amount) * style_onset(w, Float(o->start)));
  if (const StyleOperator* o = style.noise)
    shift =
        shift + style_noise(Vec3(load(&t.groom_u[l]), load(&t.groom_v[l]), w), Float(o->frequency), load(&t.noise_phase[l])) *
                    (Float(o->amount) * style_onset(w, Float(o->start)));
  if (const StyleOperator* o = style.frizz)
    shift = shift + style_frizz(w, Float(o->frequency), Vec3(load(&t.frizz_a[l]), load(&t.frizz_b[l]), load(&t.frizz_c[l]))) *
                        (load(&t.frizz[l]) * style_onset(w, Float(o->start)));
  return shift;
}

// First pass: every control point of the strands in lanes l …, from the base spline and the style.
PELAGE_LANES_FN void strand_points(const BundleCage& cage, const StrandStyle& style, const StrandTraits& traits, std::size_t l,
                                   float shortest, float longest, StrandGroup& g) {
  const float spans = static_cast<float>(cage.spans), last = spans - 1;
  const auto span_at = [&](float w) { return std::min(std::floor(w * spans), last); };
  const Float length = load(&traits.length[l]), root_width(cage.mesh->width);
  Float weight[4];
  strand_weights(load(&traits.u[l]), load(&traits.v[l]), weight);
  StrandCubic cubic;
  int cubic_of = -1;  // the uniform span that `cubic` is of
  for (std::size_t i = 0; i < g.points; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(g.points - 1);
    const Float w = length * Float(t), x = w * Float(spans);
    CagePlace at;
    at.span = min(floor(x), Float(last)), at.t = x - at.span;
    at.uniform = span_at(t * shortest) == span_at(t * longest) ? static_cast<int>(span_at(t * shortest)) : -1;
    if (style.moves_across) {
      const Vec2 uv = strand_across_at(style, traits, l, w);
      strand_weights(uv.x, uv.y, weight);
    }
    if (style.moves_across || at.uniform < 0 || at.uniform != cubic_of)
      cubic = strand_cubic(cage, at, weight), cubic_of = at.uniform;
    Vec3 p = curve_cubic_onward(cubic.c[0], cubic.c[1], cubic.c[2], cubic.c[3], at.t);
    if (style.shifts) {
      const Vec3 along = v_normalize(curve_cubic_derivative(cubic.c[1], cubic.c[2], cubic.c[3], min(at.t, Float(1.0f))));
      const Vec3 side = strand_normal(cage, at);
      const Vec3 normal = v_normalize(side - along * dot(side, along)), binormal = cross(along, normal);
      const Vec2 shift = strand_shift(style, traits, l, w);
      p = p + normal * shift.x + binormal * shift.y;
    }
    Float width = root_width;
    if (style.taper) width = root_width * style_taper(Float(t), Float(style.taper->start), load(&traits.tip_width[l]));
    const std::size_t to = i * StrandGroup::kLanes + l;
    store(p.x, &g.x[to]), store(p.y, &g.y[to]), store(p.z, &g.z[to]);
    store(width, &g.width[to]);
    store(strand_occlusion(cage, at, weight), &g.occlusion[to]);
  }
}

// Second pass: points move out of their bends, by what chords between them cut off; and tangents, from the points before and behind.
PELAGE_LANES_FN void strand_chords(std::size_t l, StrandGroup& g) {
  const auto styled = [&](std::size_t i) {
    const std::size_t at = i * StrandGroup::kLanes + l;
    return Vec3(load(&g.x[at]), load(&g.y[at]), load(&g.z[at]));
  };
  Vec3 here = styled(0), before = here, styled_here = here, styled_behind = styled(1);
  for (std::size_t i = 0; i < g.points; ++i) {
    Vec3 behind = here;
    if (i + 2 < g.points) {
      const Vec3 beyond = styled(i + 2);
      behind = style_chord_point(styled_here, styled_behind, beyond);
      styled_here = styled_behind, styled_behind = beyond;
    } else if (i + 2 == g.points) {
      behind = styled_behind;
    }
    const Vec3 tangent = v_normalize(behind - before);
    const std::size_t to = i * StrandGroup::kLanes + l;
    store(here.x, &g.x[to]), store(here.y, &g.y[to]), store(here.z, &g.z[to]);
    store(tangent.x, &g.tx[to]), store(tangent.y, &g.ty[to]), store(tangent.z, &g.tz[to]);
    before = here, here = behind;
  }
}

PELAGE_LANES_FN void strand_group(const BundleCage& cage, const StrandTraits& traits, StrandGroup& g) {
  const StrandStyle style = strand_style(cage);
  const auto [shortest, longest] = std::minmax_element(traits.length.begin(), traits.length.end());
  for (std::size_t l = 0; l < StrandGroup::kLanes; l += static_cast<std::size_t>(lanes())) {
    strand_points(cage, style, traits, l, *shortest, *longest, g);
    strand_chords(l, g);
  }
}
