// Drawing the direction of light for a bundle: one of its three parts by energy, then as the fiber's lobes are drawn (sampling.h).
// What the bundle takes away from a lobe on its way to each side is left to the weight.
//   ScatterAggregateChoice c = scatter_choice_aggregate(a)                      per shading point; a from scatter_prepare_aggregate
//   ScatterDirection d = scatter_sample_aggregate_marschner(a, c, u)
//   Float p = scatter_pdf_aggregate_marschner(a, c, d.sin_i, d.cos_i, d.phi)      per solid angle, all parts together

const float kAggregateMaxWeight = 3.0f;  // value over density of a direction that is drawn; luminance, ours

struct ScatterAggregateChoice {
  ScatterChoice near;  // of the lobes within a part; each sums to 1
  ScatterChoice through;
  Float p_near;  // of the parts; what is left is the backward lobe's
  Float p_through;
  Float p_back;
};

PELAGE_FN Float scatter_energies_luminance(ScatterEnergies e) { return v_luminance(scatter_energies_sum(e)); }
PELAGE_FN ScatterChoice scatter_choice_energies(ScatterEnergies e) {
  return scatter_choice(v_luminance(e.r), e.tt, e.trt, e.rest);
}
PELAGE_FN ScatterAggregateChoice scatter_choice_aggregate(ScatterAggregate a) {
  Float near = scatter_energies_luminance(a.first);
  Float through = scatter_energies_luminance(a.straight);
  Float back = v_luminance(a.a_back);
  Float inv = Float(1.0f) / max(near + through + back, Float(1.0e-30f));
  ScatterAggregateChoice c;
  c.near = scatter_choice_energies(a.first);
  c.through = scatter_choice_energies(a.straight);
  c.p_near = near * inv;
  c.p_through = through * inv;
  c.p_back = back * inv;
  return c;
}

// u.x serves twice: for the part, and stretched over its interval for the lobe within.
PELAGE_FN Vec4 scatter_numbers_within(Vec4 u, Float begin, Float size) {
  return Vec4(v_clamp((u.x - begin) / max(size, Float(1.0e-30f)), Float(0.0f), Float(0.99999994f)), u.y, u.z, u.w);
}
// Of the three directions the one whose part u.x chooses.
PELAGE_FN ScatterDirection scatter_chosen_part(ScatterAggregate a, ScatterAggregateChoice c, Vec4 u, ScatterDirection near,
                                               ScatterDirection through) {
  ScatterDirection back = scatter_direction(scatter_sample_cone(a.back, u.y, u.z), Float(kTwoPi) * u.w, Float(3.0f));
  Mask is_near = u.x < c.p_near;
  Mask is_through = u.x < c.p_near + c.p_through;
  ScatterDirection d;
  d.sin_i = select(is_near, near.sin_i, select(is_through, through.sin_i, back.sin_i));
  d.cos_i = select(is_near, near.cos_i, select(is_through, through.cos_i, back.cos_i));
  d.phi = select(is_near, near.phi, select(is_through, through.phi, back.phi));
  d.lobe = select(is_near, near.lobe, select(is_through, through.lobe, back.lobe));
  return d;
}
PELAGE_FN Float scatter_pdf_parts(ScatterAggregate a, ScatterAggregateChoice c, Float near, Float through, Float sin_i,
                                  Float cos_i) {
  return c.p_near * near + c.p_through * through + c.p_back * Float(kInvTwoPi) * scatter_cone_value(a.back, sin_i, cos_i);
}

PELAGE_FN ScatterDirection scatter_sample_aggregate_marschner(ScatterAggregate a, ScatterAggregateChoice c, Vec4 u) {
  return scatter_chosen_part(a, c, u,
                             scatter_sample_marschner(a.near, c.near, scatter_numbers_within(u, Float(0.0f), c.p_near)),
                             scatter_sample_marschner(a.through, c.through, scatter_numbers_within(u, c.p_near, c.p_through)));
}
PELAGE_FN Float scatter_pdf_aggregate_marschner(ScatterAggregate a, ScatterAggregateChoice c, Float sin_i, Float cos_i,
                                                Float phi) {
  return scatter_pdf_parts(a, c, scatter_pdf_marschner(a.near, c.near, sin_i, cos_i, phi),
                           scatter_pdf_marschner(a.through, c.through, sin_i, cos_i, phi), sin_i, cos_i);
}
PELAGE_FN ScatterDirection scatter_sample_aggregate_zhu(ScatterAggregate a, ScatterAggregateChoice c, Vec4 u) {
  return scatter_chosen_part(a, c, u, scatter_sample_zhu(a.near, c.near, scatter_numbers_within(u, Float(0.0f), c.p_near)),
                             scatter_sample_zhu(a.through, c.through, scatter_numbers_within(u, c.p_near, c.p_through)));
}
PELAGE_FN Float scatter_pdf_aggregate_zhu(ScatterAggregate a, ScatterAggregateChoice c, Float sin_i, Float cos_i, Float phi) {
  return scatter_pdf_parts(a, c, scatter_pdf_zhu(a.near, c.near, sin_i, cos_i, phi),
                           scatter_pdf_zhu(a.through, c.through, sin_i, cos_i, phi), sin_i, cos_i);
}
