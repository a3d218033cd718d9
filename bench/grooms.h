// The grooms that benchmark cases are named after, each before the default camera.
#pragma once

#include <pelage/scene.h>

#include <memory>
#include <string>
#include <vector>

namespace pelage::bench {

/// straight50k, curly50k, curly200k (grown) and sintel (a file of PELAGE_DATA).
const std::vector<std::string>& groom_names();

/// The strands of that groom, made once and kept while someone uses them. Throws Skip where the file is missing.
std::shared_ptr<const StrandSet> groom(const std::string& name);

/// That groom before the default camera, one segment per span.
Scene groom_scene(const std::string& name);

}  // namespace pelage::bench
