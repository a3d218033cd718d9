#include "filter/oidn.h"

#include <pelage/error.h>

#include "core/check.h"

#ifdef PELAGE_HAS_OIDN
#include <OpenImageDenoise/oidn.hpp>

namespace pelage {
namespace {

void set_image(oidn::FilterRef& filter, const char* name, Image& image) {
  const std::size_t stride = image.channel_count() * sizeof(float);
  filter.setImage(name, image.pixels.data(), oidn::Format::Float3, static_cast<std::size_t>(image.width),
                  static_cast<std::size_t>(image.height), 0, stride, stride * static_cast<std::size_t>(image.width));
}

}  // namespace

void require_oidn() {}

Image oidn_denoise(Image color, Image albedo, Image normal) {
  PELAGE_CHECK(color.channel_count() >= 3 && albedo.channel_count() >= 3 && normal.channel_count() >= 3);
  PELAGE_CHECK_EQ(albedo.pixels.size() / albedo.channel_count(), color.pixels.size() / color.channel_count());
  PELAGE_CHECK_EQ(normal.pixels.size() / normal.channel_count(), color.pixels.size() / color.channel_count());
  Image result = color;
  oidn::DeviceRef device = oidn::newDevice(oidn::DeviceType::CPU);
  device.commit();
  oidn::FilterRef filter = device.newFilter("RT");
  set_image(filter, "color", color);
  set_image(filter, "albedo", albedo);
  set_image(filter, "normal", normal);
  set_image(filter, "output", result);
  filter.set("hdr", true);
  filter.commit();
  filter.execute();
  const char* message = nullptr;
  if (device.getError(message) != oidn::Error::None)
    throw Error("filter.oidn", "", message ? message : "failed", "choose another method");
  return result;
}

}  // namespace pelage
#else
namespace pelage {

void require_oidn() {
  throw Error(
      "settings", "method", "this build has no Open Image Denoise",
      "install it from https://www.openimagedenoise.org, configure with -DOpenImageDenoise_DIR=…/lib/cmake/OpenImageDenoise-…");
}

Image oidn_denoise(Image, Image, Image) {
  require_oidn();
  return {};
}

}  // namespace pelage
#endif
