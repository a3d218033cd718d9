// SSIM from its definition, one window at a time in double: what tests and benchmarks check the fast one against.
#pragma once

#include <pelage/image.h>

#include <cmath>

namespace pelage::metrics {

struct SsimTerms {
  double similarity, structure;
};

/// The window around a pixel at least five from the edge, in one channel; its moments are taken about their means.
inline SsimTerms naive_ssim(const Image& t, const Image& r, int x, int y, std::size_t c) {
  double weight = 0, mt = 0, mr = 0, vt = 0, vr = 0, cov = 0;
  const auto for_each = [&](const auto& body) {
    for (int dy = -5; dy <= 5; ++dy)
      for (int dx = -5; dx <= 5; ++dx)
        body(std::exp(-(dx * dx + dy * dy) / (2 * 1.5 * 1.5)), double{t.at(x + dx, y + dy)[c]},
             double{r.at(x + dx, y + dy)[c]});
  };
  for_each([&](double w, double a, double b) { weight += w, mt += w * a, mr += w * b; });
  mt /= weight, mr /= weight;
  for_each([&](double w, double a, double b) {
    vt += w * (a - mt) * (a - mt) / weight, vr += w * (b - mr) * (b - mr) / weight, cov += w * (a - mt) * (b - mr) / weight;
  });
  const double c1 = 1e-4, c2 = 9e-4;
  const double structure = (2 * cov + c2) / (vt + vr + c2);
  return {structure * (2 * mt * mr + c1) / (mt * mt + mr * mr + c1), structure};
}

}  // namespace pelage::metrics
