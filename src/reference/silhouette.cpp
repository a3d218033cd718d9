#include "reference/silhouette.h"

#include <algorithm>
#include <cmath>

#include "frame/camera_view.h"

namespace pelage {
namespace {

constexpr float kMargin = 1;  ///< pixels, for what projection and rays round differently

/// The square that a pixel's coordinate lies in, of `count`.
int square(float pixel, int side, int count) {
  return static_cast<int>(std::clamp(std::floor(pixel / static_cast<float>(side)), 0.f, static_cast<float>(count - 1)));
}

}  // namespace

Silhouette::Silhouette(const CameraView& view)
    : view_(view), columns_((view.width + kSquare - 1) / kSquare), rows_((view.height + kSquare - 1) / kSquare),
      marked_(index(0, rows_), 0) {}

void Silhouette::add(std::span<const Vec4> balls) {
  Vec2 lower{INFINITY, INFINITY}, upper{-INFINITY, -INFINITY};
  for (const Vec4& ball : balls) {
    const Vec3 c = transform_point(view_.world_to_camera, {ball.x, ball.y, ball.z});
    const float nearest = c.z - ball.w;
    if (view_.perspective && !(nearest > 0)) return marked_.assign(marked_.size(), 1);
    // What is seen of c + d, |d| <= r, is off what is seen of c by focal (d.x - d.z c.x/c.z)/(c.z + d.z), likewise y.
    const Vec2 slope = view_.perspective ? Vec2(std::fabs(c.x) / c.z, std::fabs(c.y) / c.z) : Vec2();
    const float r = ball.w * pixels_per_metre(view_, nearest);
    const Vec2 at = project(view_, c), around(r * (1 + slope.x) + kMargin, r * (1 + slope.y) + kMargin);
    lower = {std::min(lower.x, at.x - around.x), std::min(lower.y, at.y - around.y)};
    upper = {std::max(upper.x, at.x + around.x), std::max(upper.y, at.y + around.y)};
  }
  const auto width = static_cast<float>(view_.width), height = static_cast<float>(view_.height);
  if (!(lower.x < width && lower.y < height && upper.x >= 0 && upper.y >= 0)) return;
  const int left = square(lower.x, kSquare, columns_), right = square(upper.x, kSquare, columns_);
  for (int row = square(lower.y, kSquare, rows_); row <= square(upper.y, kSquare, rows_); ++row)
    std::fill(&marked_[index(left, row)], &marked_[index(right, row)] + 1, std::uint8_t{1});
}

}  // namespace pelage
