// Errors as colors.
#include <pelage/error.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/check.h"
#include "metrics/field.h"

namespace pelage {
namespace {

// Every fifth entry of the maps "magma" and "viridis" of matplotlib (van der Walt and Smith 2015, CC0), sRGB bytes; linear
// in between stays within one step of 255 of the whole tables.
constexpr std::size_t kStops = 52;
using ColorMap = std::array<std::array<std::uint8_t, 3>, kStops>;
constexpr ColorMap kMagma{{{0, 0, 4},       {2, 2, 11},      {5, 4, 22},      {9, 7, 32},      {14, 11, 43},    {20, 14, 54},
                           {26, 16, 66},    {33, 17, 78},    {41, 17, 90},    {49, 17, 101},   {57, 15, 110},   {66, 15, 117},
                           {74, 16, 121},   {82, 19, 124},   {90, 22, 126},   {98, 25, 128},   {106, 28, 129},  {114, 31, 129},
                           {121, 34, 130},  {129, 37, 129},  {137, 40, 129},  {145, 43, 129},  {153, 45, 128},  {161, 48, 126},
                           {170, 51, 125},  {178, 53, 123},  {186, 56, 120},  {194, 59, 117},  {202, 62, 114},  {210, 66, 111},
                           {217, 70, 107},  {224, 76, 103},  {231, 82, 99},   {236, 88, 96},   {241, 96, 93},   {244, 105, 92},
                           {247, 114, 92},  {249, 123, 93},  {251, 133, 96},  {252, 142, 100}, {253, 152, 105}, {254, 161, 110},
                           {254, 170, 116}, {254, 180, 123}, {254, 189, 130}, {254, 198, 138}, {254, 207, 146}, {254, 216, 154},
                           {253, 226, 163}, {253, 235, 172}, {252, 244, 182}, {252, 253, 191}}};
constexpr ColorMap kViridis{{{68, 1, 84},    {70, 8, 92},    {71, 16, 99},   {72, 23, 105},  {72, 29, 111},  {72, 36, 117},
                             {71, 42, 122},  {70, 48, 126},  {69, 55, 129},  {67, 61, 132},  {65, 66, 135},  {63, 72, 137},
                             {61, 78, 138},  {58, 83, 139},  {56, 89, 140},  {53, 94, 141},  {51, 99, 141},  {49, 104, 142},
                             {46, 109, 142}, {44, 113, 142}, {42, 118, 142}, {41, 123, 142}, {39, 128, 142}, {37, 132, 142},
                             {35, 137, 142}, {33, 142, 141}, {32, 146, 140}, {31, 151, 139}, {30, 156, 137}, {31, 161, 136},
                             {33, 165, 133}, {36, 170, 131}, {40, 174, 128}, {46, 179, 124}, {53, 183, 121}, {61, 188, 116},
                             {70, 192, 111}, {80, 196, 106}, {90, 200, 100}, {101, 203, 94}, {112, 207, 87}, {124, 210, 80},
                             {137, 213, 72}, {149, 216, 64}, {162, 218, 55}, {176, 221, 47}, {189, 223, 38}, {202, 225, 31},
                             {216, 226, 25}, {229, 228, 25}, {241, 229, 29}, {253, 231, 37}}};

const ColorMap& color_map_of(const std::string& key) { return key.starts_with("flip") ? kMagma : kViridis; }

}  // namespace

Image color_error(const ErrorMap& map, float scale) {
  PELAGE_CHECK_EQ(map.error.channel_count(), 1u);
  const ColorMap& colors = color_map_of(map.key);
  Image out(map.error.width, map.error.height, {"R", "G", "B"});
  metrics::for_each_row(out.height, [&](int y) {
    for (int x = 0; x < out.width; ++x) {
      const float share = scale > 0 ? std::clamp(*map.error.at(x, y) / scale, 0.f, 1.f) : 0;
      const float position = share * (kStops - 1);
      const std::size_t i = std::min(kStops - 2, static_cast<std::size_t>(position));
      const float f = position - static_cast<float>(i);
      for (std::size_t c = 0; c < 3; ++c)
        out.at(x, y)[c] = ((1 - f) * static_cast<float>(colors[i][c]) + f * static_cast<float>(colors[i + 1][c])) / 255;
    }
  });
  return out;
}

float color_scale(const ErrorMap& map) {
  for (const Metric& metric : registered_metrics())
    if (metric.key == map.key && metric.map_scale > 0) return metric.map_scale;
  std::vector<float> errors = map.error.pixels;
  if (errors.empty()) return 1;
  const auto at = errors.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(errors.size() - 1) * 0.99);
  std::nth_element(errors.begin(), at, errors.end());
  if (*at > 0) return *at;
  const float largest = *std::max_element(errors.begin(), errors.end());
  return largest > 0 ? largest : 1;
}

}  // namespace pelage
