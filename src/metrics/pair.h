// Two pictures made comparable: same size, finite, over black, in the domain that a metric wants.
#pragma once

#include <pelage/metrics.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace pelage::metrics {

/// R, G, B and what covers the pixel, taken out of a picture's channels.
struct Colors {
  Image rgb;                    ///< as stored: premultiplied where linear, straight where display-encoded
  std::vector<float> alpha;     ///< one per pixel; empty: opaque
  std::vector<float> coverage;  ///< channel `coverage`, or else `A`; one per pixel; empty: the picture has neither
};

/// Throws Error where `picture` has no colors, or where a value that is compared is NaN or infinite.
Colors colors_of(const Picture& picture);

/// The number of the channel called `name`, if there is one.
std::optional<std::size_t> channel(const Image& image, const std::string& name);

/// Display-encoded colors as linear ones.
Image decode_display(Image rgb);

/// A pair, in the domains that were asked for so far.
class Pair {
 public:
  /// Throws Error as compare_images() does.
  Pair(const Picture& test, const Picture& reference, const CompareOptions& options);

  /// In which the pair is compared: display where a tone map was chosen or one of them is display-encoded.
  Encoding domain() const { return domain_; }
  int width() const { return test_.colors.rgb.width; }
  int height() const { return test_.colors.rgb.height; }
  /// As a metric that wants `domain` sees it. Valid while this and `options` live; not for two threads at once.
  MetricInput input(Encoding domain);

 private:
  struct Side {
    Encoding encoding;
    Colors colors;
    std::optional<Image> linear, display;
  };
  const Image& in_domain(Side& side, Encoding domain) const;

  const CompareOptions& options_;
  Side test_, reference_;
  Encoding domain_;
  ToneMap tone_map_;
};

}  // namespace pelage::metrics
