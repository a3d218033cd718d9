// A bundle of parallel fibers in an elliptical section as rays see it: how many they meet, how much of it is hair, and how much
// of the light reaches what the eye sees. Derivations: docs/derivations/aggregated_scattering.md.
//   ScatterBundle b = scatter_bundle_buffon(hairs, radius, half_width, half_depth)     per segment, seen from the eye
//   Float share = scatter_bundle_coverage(b)                                             of the width, where a ray meets hair
//   ScatterWay w = scatter_bundle_way(b, cos_phi)                                        per light
//   Float v = scatter_bundle_visible(b, w, loss)                                         of what the eye sees, lit

const float kGapsMaxRelError = 9.0e-3f;   // scatter_bundle_gaps, c >= 0
const float kVisibleMaxAbsError = 0.07f;  // scatter_bundle_visible without its joint part, against quadrature; 0.007 on average
const float kFewestCrossings = 0.02f;     // fewer hairs than this on the mean way count as this many
const float kLeastLoss = 0.01f;           // of scatter_bundle_clumping, which is 1 there

struct ScatterBundle {
  Float reach;     // mean crossings times half the width that they are spread over, metres
  Float wide;      // semi-axis across the view
  Float wide2;     // its square
  Float deep2;     // square of the semi-axis along the view
  Float density;   // rho: share of the section that is hair, 0...1
  Float longest;   // mean number of hairs on the longest way along the view
  Float coverage;  // share of the rays along the view that meet a hair
};

// Share of the rays over an ellipse of hairs placed at random that meet none: the integral of e^(-c sqrt(1 - h^2)) over the offset
// h in [0, 1], c the mean number on the longest way. A rational fit with the right slope at 0 and the right power at infinity.
PELAGE_FN Float scatter_bundle_gaps(Float c) {
  Float p = Float(1.0f) + c * (Float(-0.01091336f) + c * Float(0.05805625f));
  Float q =
      Float(1.0f) + c * (Float(0.7744848f) + c * (Float(0.39747403f) + c * (Float(0.01153154f) + c * Float(0.05805625f))));
  return p / q;
}
// The mean over the width is pi/4 of the longest way.
PELAGE_FN Float scatter_longest_way(Float n) { return Float(1.27323954f) * max(n, Float(kFewestCrossings)); }

PELAGE_FN ScatterBundle scatter_bundle_with_reach(Float reach, Float density, Float half_width, Float half_depth) {
  ScatterBundle b;
  b.reach = reach;
  b.wide = half_width;
  b.wide2 = half_width * half_width;
  b.deep2 = half_depth * half_depth;
  b.density = min(density, Float(1.0f));
  b.longest = scatter_longest_way(reach / half_width);
  b.coverage = Float(1.0f) - scatter_bundle_gaps(b.longest);
  return b;
}
// rho and n by Huang 2025, section 4 (references.bib: Huang2025LevelOfDetail): rho = N r^2/(r_A r_B), n = rho l sqrt(N/(pi r_A r_B)),
// r_A and r_B semi-axes, > 0. l is the mean chord, which for rays over the width 2 w of an ellipse is its area over that,
// pi r_A r_B/(2 w).
PELAGE_FN ScatterBundle scatter_bundle_huang(Float hairs, Float radius, Float half_width, Float half_depth) {
  Float section = half_width * half_depth;
  Float density = hairs * radius * radius / section;
  return scatter_bundle_with_reach(density * sqrt(hairs * section) * Float(0.886226925f), density, half_width, half_depth);
}
// n by Buffon: N hairs of width 2 r over the width 2 w, wherever they lie, are met N r/w times on average.
PELAGE_FN ScatterBundle scatter_bundle_buffon(Float hairs, Float radius, Float half_width, Float half_depth) {
  return scatter_bundle_with_reach(hairs * radius, hairs * radius * radius / (half_width * half_depth), half_width, half_depth);
}

// Mean number of hairs on a straight way through the bundle, rays that meet none included. Light comes from cos_phi and goes to
// the eye: the way runs along the difference of both directions. cos_phi = -1: straight through.
PELAGE_FN Float scatter_bundle_crossings(ScatterBundle b, Float cos_phi) {
  Float through = Float(0.5f) - Float(0.5f) * cos_phi;  // sin^2(phi/2)
  return b.reach / sqrt(b.wide2 * through + b.deep2 * (Float(1.0f) - through));
}
// Share of the bundle's width, seen from the eye, that hair covers.
PELAGE_FN Float scatter_bundle_coverage(ScatterBundle b) { return b.coverage; }

// What such bundles take of the light on its way through them over what their hairs would take one by one, where each hair takes the
// share `loss`: a bundle takes 1 - F(loss c), its hairs loss n. 1: of hairs that do not hide each other, or that take nothing.
PELAGE_FN Float scatter_bundle_clumping(ScatterBundle b, Float loss) {
  Float taken = b.longest * max(loss, Float(kLeastLoss));
  return min(Float(1.27323954f) * (Float(1.0f) - scatter_bundle_gaps(taken)) / taken, Float(1.0f));
}

// The way from what the eye sees to a light.
struct ScatterWay {
  Float seen;     // half the width of the bundle as the light sees it, metres
  Float longest;  // mean number of hairs on the longest way through the bundle toward the light
  Float cosine;   // between eye and light where the ellipse is stretched to a circle
  Float joint;    // how far both ways are one: 1 where the light stands behind the eye
};
// Ways to eye and light part within a hair's width over the mean free path, 4 rho/pi radians.
PELAGE_FN ScatterWay scatter_bundle_way(ScatterBundle b, Float cos_phi) {
  Float cos2 = cos_phi * cos_phi;
  Float seen = sqrt(b.wide2 * cos2 + b.deep2 * max(Float(1.0f) - cos2, Float(0.0f)));  // half the width from the light
  Float apart = sqrt(max(Float(2.0f) - Float(2.0f) * cos_phi, Float(0.0f)));
  Float together = Float(1.27323954f) * b.density + Float(1.0e-6f);
  ScatterWay w;
  w.seen = seen;
  w.longest = scatter_longest_way(b.reach / seen);
  w.cosine = v_clamp(cos_phi * b.wide / seen, Float(-1.0f), Float(1.0f));
  w.joint = together / (together + apart);
  return w;
}

// Mean of (1 - loss)^k over all that the eye sees, k hairs on the way from there to the light: loss 1 asks for none, loss 1 - a
// for light that keeps the share a at each. Hairs placed at random make it the mean of e^-(loss x), x the mean number on the way.
// In a circle it is, within kVisibleMaxAbsError, linear in the cosine between the ways; both ends are integrals over the offset
// that scatter_bundle_gaps gives: the same way there and back, and the rest of the way that the eye's ray is on.
PELAGE_FN Float scatter_bundle_visible(ScatterBundle b, ScatterWay w, Float loss) {
  Float g = w.longest * loss;
  Float sum = b.longest + g;
  Float per_hit = b.longest / b.coverage;
  Float same = per_hit * (Float(1.0f) - scatter_bundle_gaps(sum)) / sum;
  // A difference quotient over (c - g), never of too close points.
  Float middle = Float(0.5f) * sum;
  Float apart = max(Float(0.5f) * abs(b.longest - g), Float(0.02f) * middle + Float(1.0e-3f));
  Float opposite =
      per_hit * (scatter_bundle_gaps(max(middle - apart, Float(0.0f))) - scatter_bundle_gaps(middle + apart)) / (apart + apart);
  Float near = same + (Float(1.0f) - same) * w.joint;
  Float v = near * (Float(0.5f) + Float(0.5f) * w.cosine) + opposite * (Float(0.5f) - Float(0.5f) * w.cosine);
  return v_clamp(v, Float(0.0f), Float(1.0f));
}
// Share of what is sent from anywhere in the bundle in any direction that leaves without meeting a hair: of light that all hairs
// send in all directions, the coverage over the crossings (Cauchy's formula; references.bib: Santalo1976Integral). The mean of the view's direction and the diagonal.
PELAGE_FN Float scatter_bundle_escape(ScatterBundle b) {
  Float diagonal = scatter_longest_way(b.reach / sqrt(Float(0.5f) * (b.wide2 + b.deep2)));
  Float there = (Float(1.0f) - scatter_bundle_gaps(diagonal)) / diagonal;
  return min(Float(0.636619772f) * (b.coverage / b.longest + there), Float(1.0f));
}
