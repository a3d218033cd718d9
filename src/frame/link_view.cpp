// Debug views of strand linking: which pixels it has filled, and how opaque alpha fix makes them.
#include <utility>

#include "composite/debug_view.h"
#include "core/check.h"
#include "filter/alpha_fix.h"
#include "filter/link.h"
#include "filter/strand_curves.h"
#include "frame/linked_frame.h"
#include "kernel/scalar.h"

namespace pelage {
namespace {

constexpr Vec3 kHit{0.6f, 0.6f, 0.6f}, kFilled{1, 0.5f, 0.1f};  // sRGB

/// Views of the picture's size, black where nothing was put.
class LinkPainter {
 public:
  LinkPainter(int width, int height)
      : view_{Image(width, height, {"R", "G", "B", "A"}), Image(width, height, {"R", "G", "B", "A"})} {
    for (std::size_t i = 3; i < view_.display.pixels.size(); i += 4) view_.display.pixels[i] = 1;
  }
  void put(int x, int y, float value, Vec3 color) {
    float *data = view_.data.at(x, y), *display = view_.display.at(x, y);
    data[0] = data[1] = data[2] = value, data[3] = 1;
    display[0] = color.x, display[1] = color.y, display[2] = color.z;
  }
  DebugView take() { return std::move(view_); }

 private:
  DebugView view_;
};

void paint_linked(const StrandLayer& layer, LinkPainter& painter) {
  layer.hair.for_each(0, static_cast<std::size_t>(layer.height), [&](int x, int y) {
    const bool filled = layer.visibility[layer.index(x, y)].is_filled();
    painter.put(x + layer.left, y + layer.top, filled ? 2 : 1, filled ? kFilled : kHit);
  });
}

void paint_alpha(const Matte& matte, LinkPainter& painter) {
  for (int y = 0; y < matte.height; ++y)
    for (int x = 0; x < matte.width; ++x) {
      const std::size_t p = matte.index(x, y);
      const float alpha = matte.coverage.empty() ? matte.color[p].w : matte.coverage[p];
      if (alpha > 0)
        painter.put(x + matte.left, y + matte.top, alpha, kernel::composite_srgb_encode3(Vec3(alpha, alpha, alpha)));
    }
}

}  // namespace

DebugView render_link_view(const FrameInputs& inputs, View what, Stages& stages) {
  PELAGE_CHECK(what == View::kLinked || what == View::kLinkAlpha);
  const LinkSettings& settings = inputs.scene.settings.link;
  StrandLayer layer = render_strand_layer(inputs, 1, settings.alpha == LinkAlpha::kCoverage, stages).layer;
  const std::uint64_t pixels = layer.visibility.size();
  Links links;
  if (settings.link)
    stages.run("filter.link", "pixels", [&](const Progress&) {
      links = link_strands(layer, GroomCurves(inputs.scene, inputs.view), settings);
      return StageWork{pixels, links.fills.capacity() * sizeof(Fill)};
    });
  Matte matte;
  stages.run("filter.alpha", "pixels", [&](const Progress&) {
    AlphaStats stats;
    matte = fix_alpha(layer, links, settings.alpha, 0, stats);
    return StageWork{pixels, matte.bytes()};
  });
  DebugView view;
  stages.run("composite", "pixels", [&](const Progress&) {
    LinkPainter painter(inputs.view.width, inputs.view.height);
    if (what == View::kLinked) paint_linked(layer, painter);
    else paint_alpha(matte, painter);
    view = painter.take();
    return StageWork{pixels, (view.data.pixels.size() + view.display.pixels.size()) * sizeof(float)};
  });
  return view;
}

}  // namespace pelage
