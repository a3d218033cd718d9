#include "picture_file.h"

#include <fmt/format.h>
#include <pelage/error.h>
#include <pelage/io.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "io/atomic_file.h"

namespace pelage::cli {
namespace {

constexpr std::string_view kEyePlace = "%V";

// The first three of four channels.
Image without_alpha(const Image& image) {
  Image result(image.width, image.height, {"R", "G", "B"});
  for (std::size_t i = 0, o = 0; i < image.pixels.size(); i += 4, o += 3)
    std::copy_n(image.pixels.data() + i, 3, result.pixels.data() + o);
  return result;
}

}  // namespace

std::string extension_of(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  return dot == std::string::npos || path[dot] == '/' ? "" : path.substr(dot + 1);
}

bool is_numbered(const std::string& path) {
  const std::size_t last = path.find_last_of("#/");
  return last != std::string::npos && path[last] == '#';
}

std::string numbered(const std::string& path, int number) {
  if (!is_numbered(path)) return path;
  const std::size_t last = path.find_last_of('#'), before = path.find_last_not_of('#', last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  return path.substr(0, first) + fmt::format("{:0{}}", number, last + 1 - first) + path.substr(last + 1);
}

bool is_for_each_eye(const std::string& path) {
  const std::size_t folder = path.find_last_of('/');
  return path.find(kEyePlace, folder == std::string::npos ? 0 : folder) != std::string::npos;
}

std::string of_eye(std::string path, int eye) {
  const std::size_t folder = path.find_last_of('/');
  for (std::size_t at = folder == std::string::npos ? 0 : folder; (at = path.find(kEyePlace, at)) != std::string::npos;)
    path.replace(at, kEyePlace.size(), eye == 0 ? "left" : "right");
  return path;
}

void check_output(const std::string& path) {
  static const std::set<std::string> known{"exr", "png", "hdr"};
  if (!known.count(extension_of(path))) throw Error(path, "", "no known picture format", "use .exr, .png or .hdr");
  const io::AtomicFile probe(path);
}

void check_gbuffer_output(const std::string& path) {
  if (extension_of(path) != "exr") throw Error(path, "", "not an EXR", "a G-buffer has many channels; call it name.exr");
  const io::AtomicFile probe(path);
}

bool write_flat_picture(const std::string& path, const Image& linear, const Image& display, bool keep_alpha) {
  const std::string extension = extension_of(path);
  if (extension == "png") write_image(path, keep_alpha ? display : without_alpha(display));
  else if (extension == "hdr") write_image(path, without_alpha(linear));
  else return false;
  return true;
}

}  // namespace pelage::cli
