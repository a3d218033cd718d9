#include <pelage/error.h>
#include <pelage/hair_mesh_styles.h>

#include <algorithm>

#include "core/nearest.h"

namespace pelage {

const std::vector<std::string>& hair_mesh_style_names() {
  static const std::vector<std::string> names{"bob", "long-wavy", "curls", "afro", "ponytail", "braid"};
  return names;
}

HairMeshStyle hair_mesh_style_from_name(const std::string& name) {
  const std::vector<std::string>& names = hair_mesh_style_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw Error("hair mesh style", name, "unknown style", "did you mean \"" + nearest_name(name, names) + "\"?");
  return static_cast<HairMeshStyle>(found - names.begin());
}

}  // namespace pelage
