// The cage of one bundle, fitted to strands.
//
// A base strand is Σ_c Σ_k B_c(u, v)·H_k(w)·P_ck: bilinear B across, spline H along, vertices P. Strands are all sampled at the
// same w, so that least squares fall apart into two small problems: first each strand by itself becomes the `layers` vertices
// that its points are nearest to (LayerSpline::project), then layer by layer these become the four corners. In between,
// strands move to the place (u, v) where the cage comes nearest to them, and the corners are solved for again.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "groom/hairmesh/fit_strands.h"
#include "groom/hairmesh/layer_spline.h"

namespace pelage {

struct FitBundle {
  std::vector<std::uint32_t> strands;        ///< of FitStrands
  std::vector<Vec2> uv;                      ///< [strands] 0…1
  std::vector<float> tip;                    ///< [strands] w of the tip; the cage reaches about as far as the longest
  std::array<std::vector<Vec3>, 4> columns;  ///< [layers] metres
  std::array<Vec3, 4> groom_uv;              ///< of the columns, 0…1; z is 0
  double length_spread = 0;                  ///< variation of the operator kLength
  double error = 0;                          ///< Σ over strands and layers of squared distances, slow part
};

/// Fills everything but `strands`, of which there is one at least.
void fit_bundle(const FitStrands& strands, const LayerSpline& spline, FitBundle& bundle);

/// Bilinear weights of the four columns.
std::array<float, 4> corner_weights(Vec2 uv);

/// The vertices of the base strand at `uv`.
void base_vertices(const FitBundle& bundle, Vec2 uv, std::vector<Vec3>& vertices);

}  // namespace pelage
