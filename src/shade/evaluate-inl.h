// The evaluation of a batch of visible strand samples under all lights, written once for one lane and for many.
//
// Included inside a namespace that has Float, Int, Vec3, Mask, the kernels and the lane access of kernel/lanes*.h, with
// PELAGE_LANES_FN defined. What differs between lights or grooms is uniform over the lanes and may branch; what differs
// between lanes may not. No include guard, on purpose.

// Camera-space place of a world-space point.
PELAGE_LANES_FN Vec3 shade_to_camera(const MapConstants& m, Vec3 p) {
  const auto row = [&](int i) {
    return p.x * Float(m.row[i][0]) + p.y * Float(m.row[i][1]) + p.z * Float(m.row[i][2]) + Float(m.row[i][3]);
  };
  return Vec3(row(0), row(1), row(2));
}

// Upper left texel of the four around a place, their weights, and whether the place is on the map at all.
struct ShadeFootprint {
  Float x, y, right, lower;
  Mask inside;
};

PELAGE_LANES_FN ShadeFootprint shade_footprint(const MapConstants& m, Vec3 c, float margin) {
  const Float scale = m.perspective ? Float(m.focal) / max(c.z, Float(m.near_plane)) : Float(m.focal);
  const Float x = Float(m.center_x) + scale * c.x - Float(0.5f), y = Float(m.center_y) + scale * c.y - Float(0.5f);
  ShadeFootprint f;
  f.inside = (c.z >= Float(m.near_plane)) && (x >= Float(margin)) && (y >= Float(margin)) && (x < Float(m.last_x - margin)) &&
             (y < Float(m.last_y - margin));
  const Float sx = v_clamp(x, Float(margin), Float(m.last_x - margin - 1)),
              sy = v_clamp(y, Float(margin), Float(m.last_y - margin - 1));
  f.x = floor(sx), f.y = floor(sy);
  f.right = v_clamp(x - f.x, Float(0.0f), Float(1.0f)), f.lower = v_clamp(y - f.y, Float(0.0f), Float(1.0f));
  return f;
}

// Strands between a light and a place, and how many more there are each metre farther from the light.
struct ShadeCrossings {
  Float n, slope;
};

PELAGE_LANES_FN ShadeCrossings shade_mix(ShadeCrossings a, ShadeCrossings b, Float t) {
  const Float s = Float(1.0f) - t;
  return {a.n * s + b.n * t, a.slope * s + b.slope * t};
}

PELAGE_LANES_FN ShadeCrossings shade_texel_crossings(const MapConstants& m, Float x, Float y, Float z) {
  const Float per_block(1.f / OpacityMap::kOriginBlock);
  const Int block = to_int(floor(y * per_block)) * Int(m.origin_width) + to_int(floor(x * per_block));
  const Float d = max(z - gather(m.depth, block), Float(0.0f));
  Float layer(0.0f), begin(0.0f), end(m.layer_end[0]);
  for (std::size_t i = 0; i + 1 < OpacityMap::kLayers; ++i) {
    const Mask beyond = d > Float(m.layer_end[i]);
    layer = layer + select(beyond, Float(1.0f), Float(0.0f));
    begin = select(beyond, Float(m.layer_end[i]), begin);
    end = select(beyond, Float(m.layer_end[i + 1]), end);
  }
  const Int slot = (to_int(y) * Int(m.width) + to_int(x)) * Int(OpacityMap::kLayers) + to_int(layer);
  const Mask first = layer == Float(0.0f);
  const Float after = to_float(gather(m.crossings, slot));
  const Float before = select(first, Float(0.0f), to_float(gather(m.crossings, select(first, slot, slot - Int(1)))));
  return {light_crossings(d, begin, end, before, after), (after - before) / (end - begin)};
}

// Strands between the light and each place; see crossings_at().
PELAGE_LANES_FN ShadeCrossings shade_crossings(const MapConstants& m, Vec3 p) {
  if (m.crossings == nullptr) return {Float(0.0f), Float(0.0f)};
  const Vec3 c = shade_to_camera(m, p);
  const ShadeFootprint f = shade_footprint(m, c, 0);
  const auto row = [&](Float y) {
    return shade_mix(shade_texel_crossings(m, f.x, y, c.z), shade_texel_crossings(m, f.x + Float(1.0f), y, c.z), f.right);
  };
  const ShadeCrossings found = shade_mix(row(f.y), row(f.y + Float(1.0f)), f.lower);
  const Float unit = select(f.inside, Float(OpacityMap::kCrossingUnit), Float(0.0f));
  return {found.n * unit, found.slope * unit};
}

// Share of the light that the meshes let pass; see mesh_visibility().
PELAGE_LANES_FN Float shade_mesh_visibility(const MapConstants& m, Vec3 p) {
  if (m.depth == nullptr) return Float(1.0f);
  const Vec3 c = shade_to_camera(m, p);
  const ShadeFootprint f = shade_footprint(m, c, 1);
  const Float texel = (m.perspective ? c.z : Float(1.0f)) / Float(m.focal);
  const Float bias = Float(kHairBias.metres) + Float(kHairBias.texels) * texel;
  const Int corner = (to_int(f.y) - Int(1)) * Int(m.width) + to_int(f.x) - Int(1);
  const auto lit = [&](int x, int y) { return light_depth_test(c.z, gather(m.depth, corner + Int(y * m.width + x)), bias); };
  const auto row = [&](int y) { return lit(0, y) * (Float(1.0f) - f.right) + lit(1, y) + lit(2, y) + lit(3, y) * f.right; };
  const Float sum = row(0) * (Float(1.0f) - f.lower) + row(1) + row(2) + row(3) * f.lower;
  return select(f.inside, sum * Float(1.f / 9), Float(1.0f));
}

// Direction to a light and the irradiance that it would give; see illuminate().
struct ShadeIllumination {
  Vec3 to_light, irradiance;
};

PELAGE_LANES_FN ShadeIllumination shade_illuminate(const LightConstants& light, Vec3 p) {
  if (light.type == Light::Type::kDirectional) return {splat(light.to_light), splat(light.intensity)};
  const Vec3 to_light = splat(light.position) - p;
  const Float d2 = max(dot(to_light, to_light), Float(1.0e-12f));
  Float share = Float(1.0f) / d2;
  ShadeIllumination i;
  i.to_light = to_light * (Float(1.0f) / sqrt(d2));
  if (light.type == Light::Type::kSpot)
    share = share * light_spot_share(dot(i.to_light, splat(light.to_light)), Float(light.cos_inner), Float(light.cos_outer));
  if (light.only_in_view) {
    const Vec3 c = shade_to_camera(light.opacity, p);
    share = select(max(abs(c.x), abs(c.y)) <= c.z, share, Float(0.0f));
  }
  i.irradiance = splat(light.intensity) * share;
  return i;
}

// A strand where it is seen, and everything about it that does not depend on the light.
struct ShadePlace {
  Vec3 position, tangent, to_eye;
  Vec3 across_o;  // direction to the eye in the normal plane, unit length
  ScatterFiber fiber;
  ScatterLobes lobes;        // of Marschner's kinds of lobes
  ScatterArtist artist;      // of Sadeghi's
  ScatterPelekis pelekis;    // of Pelekis', and of the probe's light on any
  ScatterAverages averages;  // with dual scattering
  ScatterBack back;          //
  Vec3 tuft_color;           // of what has a diffuse lobe
  ScatterBundle bundle;      // of thick hairs: of the other fibers, which shade the one that is seen
  Float others;              // of thick hairs: how many these are
  Float lean;         // of thick hairs: variance of the fibers' directions, half the mean square of the sine by which they lean
  Float upright;      // and the cosine, by which the sines of their mean inclinations are less than that of the center
  Float level_o;      // of thick hairs: cosine of the center's inclination to the eye
  Float depth_shift;  // crossings
  Float width;        // of the fiber, metres; 0: not known
  Float table;        // where its table of forward attenuation begins
};

// Lobes of the models that have Marschner's kinds. Chiang's model is near-field: its mean over the fiber is shaded with.
PELAGE_LANES_FN ScatterLobes shade_lobes(HairMaterial::Model model, ScatterFiber fiber, Float sin_o, Float cos_o) {
  if (model == HairMaterial::Model::kZhu) return scatter_prepare_zhu(fiber, sin_o, cos_o);
  if (model == HairMaterial::Model::kChiang) return scatter_prepare_chiang_far(fiber, sin_o, cos_o);
  return scatter_prepare_marschner(fiber, sin_o, cos_o);
}

PELAGE_LANES_FN ScatterArtistFiber shade_artist_fiber(const pelage::kernel::ScatterArtistFiber& a) {
  ScatterArtistFiber f;
  f.a_r = splat(a.a_r), f.a_tt = splat(a.a_tt), f.a_trt = splat(a.a_trt), f.a_glint = splat(a.a_glint);
  f.shift_r = Float(a.shift_r), f.shift_tt = Float(a.shift_tt), f.shift_trt = Float(a.shift_trt);
  f.width_r = Float(a.width_r), f.width_tt = Float(a.width_tt), f.width_trt = Float(a.width_trt);
  f.around_tt = Float(a.around_tt), f.around_glint = Float(a.around_glint);
  f.glint_angle = Float(a.glint_angle);
  return f;
}

// A place of the batch; shade_toward_eye() completes it.
PELAGE_LANES_FN ShadePlace shade_place(const ShadeConstants& k, const ShadeBatch& batch, std::size_t i) {
  const HairMaterial& material = k.material;
  const auto vec = [i](const ShadeBatch::Lanes& x, const ShadeBatch::Lanes& y, const ShadeBatch::Lanes& z) {
    return Vec3(load(x.data() + i), load(y.data() + i), load(z.data() + i));
  };
  const auto own = [&](const ShadeBatch::Lanes& lanes, float shared) {
    return k.mapped ? load(lanes.data() + i) : Float(shared);
  };
  ShadePlace s{};
  s.position = vec(batch.px, batch.py, batch.pz);
  s.tangent = vec(batch.tx, batch.ty, batch.tz);
  s.to_eye = vec(batch.ex, batch.ey, batch.ez);
  const Vec3 absorption = vec(batch.absorb_r, batch.absorb_g, batch.absorb_b);
  const Float beta_azimuthal = own(batch.beta_azimuthal, material.beta_azimuthal);
  s.fiber = scatter_fiber(Float(material.eta), own(batch.beta_longitudinal, material.beta_longitudinal), beta_azimuthal,
                          own(batch.tilt, material.cuticle_tilt), Float(material.specular_gain), absorption);
  s.table = own(batch.table, 0);
  s.depth_shift = load(batch.depth_shift.data() + i);
  s.width = Float(2.0f) * load(batch.fiber_radius.data() + i);
  if (k.bundled) {
    s.others = max(load(batch.fibers.data() + i) - Float(1.0f), Float(0.0f));
    s.lean = load(batch.lean.data() + i);
    s.bundle = scatter_bundle_buffon(s.others, load(batch.fiber_radius.data() + i), load(batch.half_width.data() + i),
                                     load(batch.half_depth.data() + i));
  }
  const bool diffuse = material.model == HairMaterial::Model::kKajiyaKay || material.model == HairMaterial::Model::kPelekis;
  if (k.probe.texels != nullptr || (diffuse && !k.dual_scattering))
    s.tuft_color = scatter_tuft_color(absorption, beta_azimuthal);
  return s;
}

// What the place scatters toward the eye, by its tangent.
PELAGE_LANES_FN void shade_toward_eye(const ShadeConstants& k, ShadePlace& s) {
  const HairMaterial& material = k.material;
  Float sin_o = v_clamp(dot(s.to_eye, s.tangent), Float(-1.0f), Float(1.0f));
  s.across_o = v_normalize(s.to_eye - s.tangent * sin_o);
  if (k.bundled) {
    s.upright = sqrt(max(Float(1.0f) - Float(2.0f) * s.lean, Float(0.0f)));
    s.level_o = sqrt(max(Float(1.0f) - sin_o * sin_o, Float(0.0f)));
    sin_o = sin_o * s.upright;
  }
  const Float cos_o = sqrt(max(Float(1.0f) - sin_o * sin_o, Float(0.0f)));
  if (k.probe.texels != nullptr || material.model == HairMaterial::Model::kPelekis)
    s.pelekis = scatter_prepare_pelekis(s.fiber, sin_o, cos_o);
  if (material.model == HairMaterial::Model::kSadeghi) {
    s.artist = scatter_prepare_sadeghi(shade_artist_fiber(k.artist), scatter_crossing_color(s.fiber.sigma_a), sin_o, cos_o);
    if (k.dual_scattering) s.averages = scatter_averages_sadeghi(s.artist);
  } else if (material.model == HairMaterial::Model::kPelekis) {
    if (k.dual_scattering) s.averages = scatter_averages_pelekis(s.pelekis);
  } else {
    s.lobes = shade_lobes(material.model, s.fiber, sin_o, cos_o);
    if (k.dual_scattering) s.averages = scatter_averages(s.lobes);
  }
  if (k.dual_scattering) s.back = scatter_back(s.averages, sin_o, cos_o);
}

// Directions of a light about the fiber.
struct ShadeAngles {
  Float sin_i, cos_i, cos_phi;
  Float apart2;   // 2 - 2 cos_phi, without its cancellation where light and eye are near each other
  Float level_i;  // of thick hairs: cosine of the center's inclination to the light
  Float met;      // of thick hairs: light that fibers meet over that of a fiber with cos_i
};

// Of fibers that lean by δ toward all sides alike about a center with inclination θ the mean square of the cosine, by which they meet light and are seen,
// is cos²θ + σ²(2 − 3 cos²θ), σ² = sin²δ/2. Its root is above the mean cosine by 2 % for δ = 57°, 11 % for 90°, both at θ = 0, where it is most.
PELAGE_LANES_FN Float shade_mean_cosine(Float cos, Float lean) {
  const Float cos2 = cos * cos;
  return sqrt(max(cos2 + lean * (Float(2.0f) - Float(3.0f) * cos2), Float(0.0f)));
}

// The mean sine of their inclinations is cos δ sin θ: lobes are looked up there.
PELAGE_LANES_FN void shade_lean(const ShadePlace& s, ShadeAngles& a) {
  a.level_i = a.cos_i;
  a.sin_i = a.sin_i * s.upright;
  a.cos_i = sqrt(max(Float(1.0f) - a.sin_i * a.sin_i, Float(1.0e-6f)));
  a.met = shade_mean_cosine(a.level_i, s.lean) / a.cos_i;
}

PELAGE_LANES_FN ShadeAngles shade_angles(const ShadePlace& s, Vec3 to_light) {
  ShadeAngles a;
  a.sin_i = v_clamp(dot(to_light, s.tangent), Float(-1.0f), Float(1.0f));
  a.cos_i = sqrt(max(Float(1.0f) - a.sin_i * a.sin_i, Float(0.0f)));
  const Vec3 across_i = v_normalize(to_light - s.tangent * a.sin_i), apart = across_i - s.across_o;
  a.cos_phi = v_clamp(dot(across_i, s.across_o), Float(-1.0f), Float(1.0f));
  a.apart2 = dot(apart, apart);
  return a;
}

// ScatterLobes or ScatterArtist, under a light of some spread.
template <class Lobes>
PELAGE_LANES_FN Lobes shade_widened(Lobes l, Float variance) {
  l.r = scatter_cone_widened(l.r, variance);
  l.tt = scatter_cone_widened(l.tt, variance);
  l.trt = scatter_cone_widened(l.trt, variance);
  return l;
}

PELAGE_LANES_FN ScatterPelekis shade_widened(ScatterPelekis l, Float variance) {
  l.r = scatter_band_widened(l.r, variance);
  l.tt = scatter_band_widened(l.tt, variance);
  l.trt = scatter_band_widened(l.trt, variance);
  return l;
}

// Variance of θ_i + θ_o under a light: its own, and that of fibers which lean, |n_i + n_o|² times that of one axis.
PELAGE_LANES_FN Float shade_spread(const ShadeConstants& k, const ShadePlace& s, const LightConstants& light, ShadeAngles a) {
  const Float spread(light.spread2);
  if (!k.bundled) return spread;
  return spread + s.lean * (a.level_i * a.level_i + s.level_o * s.level_o + Float(2.0f) * a.level_i * s.level_o * a.cos_phi);
}

// f·cos of the fiber itself under directions of some spread.
PELAGE_LANES_FN Vec3 shade_single(const ShadeConstants& k, const ShadePlace& s, const LightConstants& light, Float spread,
                                  ShadeAngles a) {
  const HairMaterial::Model model = k.material.model;
  const bool widened = k.bundled || light.spread2 > 0;
  if (model == HairMaterial::Model::kSadeghi) {
    if (light.wide) return scatter_dual_forward_sadeghi(s.artist, spread, a.sin_i, a.cos_i, a.cos_phi);
    return scatter_sadeghi(widened ? shade_widened(s.artist, spread) : s.artist, a.sin_i, a.cos_i, a.cos_phi);
  }
  if (model == HairMaterial::Model::kPelekis) {
    if (light.wide) return scatter_dual_forward_pelekis(s.pelekis, spread, a.sin_i, a.cos_phi);
    return scatter_pelekis(widened ? shade_widened(s.pelekis, spread) : s.pelekis, a.sin_i, a.cos_phi);
  }
  const ScatterLobes lobes = widened ? shade_widened(s.lobes, spread) : s.lobes;
  if (model == HairMaterial::Model::kKajiyaKay) return scatter_kajiya_kay(lobes, s.tuft_color, a.sin_i, a.cos_i);
  if (model == HairMaterial::Model::kZhu)
    return light.wide ? scatter_dual_forward_zhu(s.lobes, spread, a.sin_i, a.cos_i, a.cos_phi)
                      : scatter_zhu(lobes, a.sin_i, a.cos_i, a.cos_phi);
  return light.wide ? scatter_dual_forward_marschner(s.lobes, spread, a.sin_i, a.cos_i, a.cos_phi)
                    : scatter_marschner(lobes, a.sin_i, a.cos_i, a.cos_phi);
}

// Light that other fibers scattered forward to this one, on it and on those behind it: Zinke 2008, section 4.
PELAGE_LANES_FN Vec3 shade_forwarded(HairMaterial::Model model, const ShadePlace& s, Float variance, ShadeAngles a) {
  Vec3 forward;
  if (model == HairMaterial::Model::kSadeghi)
    forward = scatter_dual_forward_sadeghi(s.artist, variance, a.sin_i, a.cos_i, a.cos_phi);
  else if (model == HairMaterial::Model::kPelekis)
    forward = scatter_dual_forward_pelekis(s.pelekis, variance, a.sin_i, a.cos_phi);
  else if (model == HairMaterial::Model::kZhu)
    forward = scatter_dual_forward_zhu(s.lobes, variance, a.sin_i, a.cos_i, a.cos_phi);
  else forward = scatter_dual_forward_marschner(s.lobes, variance, a.sin_i, a.cos_i, a.cos_phi);
  return forward + scatter_dual_local(s.back, variance, a.sin_i, a.cos_i, a.cos_phi);
}

// Mean forward attenuation of the fibers that a light passes on its way here: they lie like this one, so light meets them
// at its own inclination, not at the eye's.
PELAGE_LANES_FN Vec3 shade_forward_attenuation(const std::vector<float>& tables, const ShadePlace& s, Float cos_i) {
  const auto channel = [&](Float sigma_a) {
    const ScatterTableCell c = scatter_table_cell(cos_i, sigma_a);
    const float* v = tables.data();
    const Int corner = to_int(c.index + s.table);
    const auto next_row = static_cast<std::size_t>(kScatterTableColumns);
    return scatter_table_mix(c, gather(v, corner), gather(v + 1, corner), gather(v + next_row, corner),
                             gather(v + next_row + 1, corner));
  };
  return Vec3(channel(s.fiber.sigma_a.x), channel(s.fiber.sigma_a.y), channel(s.fiber.sigma_a.z));
}

// The way of light to a place.
struct ShadeWay {
  Float outside;  // mean number of hairs on it that the eye does not look past too; of thick hairs without those of the bundle
  ScatterWay within;  // of thick hairs: past the others of the bundle,
  Float alone;        // and how far the bundle is alone: its share of the hairs here, 0…1
};

// What one fiber adds to the crossings of a map where it lies: its width over what the map spreads it over, a texel, of which a look-up
// blends two, or the bundle that it is drawn in.
PELAGE_LANES_FN Float shade_grain(const ShadeConstants& k, const MapConstants& m, const ShadePlace& s, ScatterWay within) {
  if (m.crossings == nullptr) return Float(0.0f);
  const Float texel =
      (m.perspective ? max(shade_to_camera(m, s.position).z, Float(m.near_plane)) : Float(1.0f)) / Float(m.focal);
  const Float spread = texel * Float(1.33333333f);
  return min(s.width / (k.bundled ? max(spread, Float(2.0f) * within.seen) : spread), Float(1.0f));
}

// What the fibers of a bundle add to the crossings of a map at its middle: half of them are nearer to the light.
PELAGE_LANES_FN Float shade_own_crossings(const ShadePlace& s, Float grain) {
  return s.bundle.reach / max(s.width, Float(1.0e-9f)) * grain;
}

// How wide what hides is, to eye and light alike, metres: a fiber; of a bundle between one of its fibers, d, and all of them side by side, D, which is what is
// drawn. They are next to each other more than at random, and maps, which see that of strands, blur bundles over their width. d^2/3 D^1/3 is what is measured
// (docs/derivations/dual_scattering.md).
PELAGE_LANES_FN Float shade_hiding_width(const ShadeConstants& k, const ShadePlace& s) {
  if (!k.bundled) return s.width;
  const Float d = max(s.width, Float(1.0e-9f)), side_by_side = d + Float(2.0f) * s.bundle.wide * s.bundle.coverage;
  return d * m_exp(Float(0.33333333f) * m_log(side_by_side / d));
}

// By how many widths of what hides the ways to eye and light part, across the fiber, where the light's has one crossing more.
PELAGE_LANES_FN Float shade_parting(const ShadeConstants& k, const ShadePlace& s, const LightConstants& light, Float slope,
                                    ShadeAngles a) {
  const Float spread = Float(2.0f) - Float(2.0f) * Float(light.mean_cosine);
  const Float apart = sqrt(a.apart2 * Float(light.mean_cosine) + spread);
  return apart * a.cos_i / max(slope * shade_hiding_width(k, s), Float(1.0e-9f));
}

// Of n crossings, those that the eye looks past too, but for what the map knows of them: where it is fine, a place that is seen lies
// in a texel with fewer strands. A texel shares its strands with the eye as a strand as wide as the texel would.
PELAGE_LANES_FN Float shade_seen_past(Float n, Float parting, Float grain) {
  return light_shared_crossings(n, parting) - grain * light_shared_crossings(n, parting * grain);
}

// Bundles are not at random either: those of a lock lie before each other, and maps no finer than a bundle do not know of the ways between them. What is
// outside of a bundle hides less than it would at random, one of many fibers by kBundlesShare, one fiber not at all (docs/derivations/dual_scattering.md).
const float kBundlesShare = 0.15f;

PELAGE_LANES_FN Float shade_bundles_hide(const ShadePlace& s) {
  return Float(1.0f) - Float(kBundlesShare) * s.others / (s.others + Float(1.0f));
}

PELAGE_LANES_FN ShadeWay shade_way(const ShadeConstants& k, const ShadePlace& s, const LightConstants& light, ShadeAngles a) {
  ShadeWay w{};
  const ShadeCrossings found = shade_crossings(light.opacity, s.position);
  const Float n = max(found.n - s.depth_shift, Float(0.0f)), parting = shade_parting(k, s, light, found.slope, a);
  if (k.bundled) w.within = scatter_bundle_way(s.bundle, a.cos_phi * Float(light.mean_cosine));
  const Float grain = shade_grain(k, light.opacity, s, w.within);
  Float others = n;
  if (k.bundled) {
    const Float own = shade_own_crossings(s, grain);
    w.alone = own / max(max(n, own), Float(1.0e-6f));
    others = max(n - own * w.alone, Float(0.0f));
  }
  w.outside = others - shade_seen_past(others, parting, grain);
  if (k.bundled) w.outside = w.outside * shade_bundles_hide(s);
  return w;
}

// Mean of (1 − loss)^k over the k other hairs of the bundle on the way. Between others, which take part of the way from each of its hairs,
// a bundle shades itself less.
PELAGE_LANES_FN Float shade_within(const ShadePlace& s, ShadeWay w, Float loss) {
  return Float(1.0f) + (scatter_bundle_visible(s.bundle, w.within, loss) - Float(1.0f)) * w.alone;
}

// Share of the light that comes through where every hair on its way takes the share `loss`.
PELAGE_LANES_FN Float shade_through(const ShadeConstants& k, const ShadePlace& s, ShadeWay w, Float loss) {
  if (!k.bundled) return scatter_dual_direct(loss * w.outside);
  return scatter_dual_direct(loss * w.outside * scatter_bundle_clumping(s.bundle, loss)) * shade_within(s, w, loss);
}

// Share of the light that meets no hair on its way.
PELAGE_LANES_FN Float shade_direct(const ShadeConstants& k, const ShadePlace& s, ShadeWay w) {
  return shade_through(k, s, w, Float(1.0f));
}

// Share of the light that comes through where every hair on the way keeps the share `each`.
PELAGE_LANES_FN Vec3 shade_kept(const ShadeConstants& k, const ShadePlace& s, ShadeWay w, Vec3 each) {
  const auto through = [&](Float share) { return shade_through(k, s, w, Float(1.0f) - share); };
  return Vec3(through(each.x), through(each.y), through(each.z));
}

// Share of light that the fibers on its way let pass to a Kajiya-Kay fiber: half of what its diffuse lobe scatters goes on.
PELAGE_LANES_FN Vec3 shade_kajiya_kay_transmittance(const ShadeConstants& k, const ShadePlace& s, ShadeWay w) {
  return shade_kept(k, s, w, s.tuft_color * Float(0.5f));
}

// What Pelekis' model has for multiple scattering where dual scattering is off: Kajiya-Kay's diffuse lobe, dimmed like it.
PELAGE_LANES_FN Vec3 shade_diffused(const ShadeConstants& k, const ShadePlace& s, ShadeWay w, ShadeAngles a) {
  if (k.material.model != HairMaterial::Model::kPelekis) return v_splat(Float(0.0f));
  return scatter_pelekis_diffused(s.tuft_color, a.cos_i) * shade_kajiya_kay_transmittance(k, s, w);
}

PELAGE_LANES_FN Vec3 shade_under(const ShadeConstants& k, const ShadePlace& s, const LightConstants& light) {
  const ShadeIllumination i = shade_illuminate(light, s.position);
  ShadeAngles a = shade_angles(s, i.to_light);
  const ShadeWay way = shade_way(k, s, light, a);
  Vec3 arriving = i.irradiance * shade_mesh_visibility(light.shadow, s.position);
  if (k.bundled) {
    shade_lean(s, a);
    arriving = arriving * a.met;
  }
  const Float spread = shade_spread(k, s, light, a);
  const Vec3 single = shade_single(k, s, light, spread, a);
  if (k.material.model == HairMaterial::Model::kKajiyaKay) return arriving * single * shade_kajiya_kay_transmittance(k, s, way);
  const Float unscattered = shade_direct(k, s, way);
  const Vec3 direct = single * unscattered;
  if (!k.dual_scattering) return arriving * (direct + shade_diffused(k, s, way, a));
  const Vec3 local = scatter_dual_local(s.back, spread, a.sin_i, a.cos_i, a.cos_phi) * unscattered;
  // Hairs on the way: those of a bundle as the share of light says that meets none of them.
  const Float n = k.bundled ? Float(0.0f) - m_log(max(unscattered, Float(1.0e-6f))) : way.outside;
  const Vec3 forwarded = shade_forwarded(k.material.model, s, scatter_dual_variance(n, s.averages.v_f) + spread, a);
  const Vec3 a_f =
      k.material.model == HairMaterial::Model::kSadeghi ? s.averages.a_f : shade_forward_attenuation(k.attenuation, s, a.cos_i);
  return arriving * (direct + local + forwarded * scatter_dual_scattered(shade_kept(k, s, way, a_f), unscattered));
}

// Prefiltered radiance about a direction; see probe_radiance().
PELAGE_LANES_FN Vec3 shade_prefiltered(const ProbeConstants& probe, Vec3 d, Float alpha) {
  const auto row = static_cast<std::int32_t>(kProbeSide) + 2, plane_size = row * row;
  const LightProbeCell c = light_probe_cell(d, alpha);
  const Int corner = to_int(c.level) * Int(3 * plane_size) + to_int(c.y) * Int(row) + to_int(c.x);
  const auto channel = [&](int plane) {
    const float* v = probe.texels + plane * plane_size;
    return light_probe_mix(c, gather(v, corner), gather(v + 1, corner), gather(v + row, corner), gather(v + row + 1, corner));
  };
  const Vec3 lower(channel(0), channel(1), channel(2)), upper(channel(3), channel(4), channel(5));
  return lower * c.sharper + upper * (Float(1.0f) - c.sharper);
}

// Irradiance by a normal; see environment_irradiance().
PELAGE_LANES_FN Vec3 shade_irradiance(const ProbeConstants& probe, Vec3 normal) {
  const LightHarmonics h = light_harmonics(normal);
  const Float y[9] = {h.c00, h.c1n, h.c10, h.c1p, h.c2nn, h.c2n, h.c20, h.c2p, h.c2pp};
  Vec3 sum(Float(0.0f), Float(0.0f), Float(0.0f));
  for (std::size_t i = 0; i < 9; ++i) sum = sum + splat(probe.irradiance[i]) * y[i];
  const Float none(0.0f);
  return Vec3(max(sum.x, none), max(sum.y, none), max(sum.z, none));
}

// Light of the probe on one lobe; `even`: mean radiance of the whole sky.
PELAGE_LANES_FN Vec3 shade_glow(const ProbeConstants& probe, const ShadePlace& s, ScatterGlow g, Vec3 even) {
  const Vec3 axis = s.across_o * g.axis.x + s.tangent * g.axis.y;
  return g.energy * (shade_prefiltered(probe, axis, g.alpha) * (Float(1.0f) - g.even) + even * g.even);
}

// The environment by its probe: R and TRT by a lobe, TT by another, what remains evenly, and what other fibers scatter by the
// irradiance of a normal that faces the eye (Lipp 2026, section 3.4). The same for every model: Pelekis' lobes stand for it.
PELAGE_LANES_FN Vec3 shade_probe(const ProbeConstants& probe, const ShadePlace& s) {
  const ScatterGlows g = scatter_glows(s.pelekis);
  const Vec3 even = splat(probe.irradiance[0] * (0.282094792f / kLightCosineBand0));
  const Vec3 diffused = s.tuft_color * shade_irradiance(probe, s.across_o) * Float(kPelekisDiffused * kInvPi);
  return shade_glow(probe, s, g.front, even) + shade_glow(probe, s, g.back, even) + s.pelekis.a_rest * even + diffused;
}

// Light that a place sends to the eye.
PELAGE_LANES_FN Vec3 shade_lit(const ShadeConstants& k, const ShadePlace& s, Float occlusion) {
  Vec3 sum(Float(0.0f), Float(0.0f), Float(0.0f));
  for (const LightConstants& light : k.lights) sum = sum + shade_under(k, s, light);
  if (k.probe.texels != nullptr) sum = sum + shade_probe(k.probe, s) * occlusion;
  return sum;
}

// The same of a place that is not yet shade_toward_eye().
PELAGE_LANES_FN Vec3 shade_straight(const ShadeConstants& k, ShadePlace s, Float occlusion) {
  shade_toward_eye(k, s);
  return shade_lit(k, s, occlusion);
}

const float kLeansLittle = 0.04f;  // variance of directions up to which wider lobes do for fibers that lean
const float kLeanLeft = 0.3f;      // share of it that widens lobes where fibers are shaded at four places of their cone

// Fibers that lean by δ toward all sides lie on a cone about the center. Where that is wide they are shaded at four places of it, on a narrower one; what
// is missing of their variance σ² = sin²δ/2 widens the lobes of each. Each counts by what the eye sees of it, its cosine.
PELAGE_LANES_FN Vec3 shade_leaning(const ShadeConstants& k, const ShadePlace& center, Float occlusion) {
  const Vec3 up = v_normalize(center.to_eye - center.tangent * dot(center.to_eye, center.tangent)),
             side = cross(center.tangent, up);
  const Float left = min(center.lean, max(Float(kLeansLittle), Float(kLeanLeft) * center.lean));
  // Places at half right angles to the eye: each coordinate has a variance of half the square of this sine.
  const Float half2 = center.lean - left, along = sqrt(half2), straight = sqrt(max(Float(1.0f) - half2 - half2, Float(0.0f)));
  Vec3 sum(Float(0.0f), Float(0.0f), Float(0.0f));
  Float seen(0.0f);
  for (const Float x : {along, Float(0.0f) - along})
    for (const Float y : {along, Float(0.0f) - along}) {
      ShadePlace s = center;
      s.tangent = v_normalize(center.tangent * straight + up * x + side * y);
      s.lean = left;
      shade_toward_eye(k, s);
      const Float shown = shade_mean_cosine(s.level_o, left) + Float(1.0e-6f);
      sum = sum + shade_lit(k, s, occlusion) * shown;
      seen = seen + shown;
    }
  return sum * (Float(1.0f) / seen);
}

// Fills r, g, b of the batch.
PELAGE_LANES_FN void shade_evaluate(const ShadeConstants& k, ShadeBatch& batch) {
  for (std::size_t i = 0; i < batch.count; i += static_cast<std::size_t>(lanes())) {
    const ShadePlace s = shade_place(k, batch, i);
    const Float occlusion = load(batch.occlusion.data() + i);
    const Mask much = s.lean > Float(kLeansLittle);
    const bool some = k.bundled && any(much), all = some && !any(s.lean <= Float(kLeansLittle));
    Vec3 sum(Float(0.0f), Float(0.0f), Float(0.0f));
    if (!all) sum = shade_straight(k, s, occlusion);
    if (some) {
      const Vec3 leaning = shade_leaning(k, s, occlusion);
      sum = Vec3(select(much, leaning.x, sum.x), select(much, leaning.y, sum.y), select(much, leaning.z, sum.z));
    }
    store(sum.x, batch.r.data() + i), store(sum.y, batch.g.data() + i), store(sum.z, batch.b.data() + i);
  }
}
