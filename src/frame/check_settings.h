// What every picture asks of its settings.
#pragma once

#include <pelage/scene.h>

namespace pelage {

/// Throws Error("settings", name, …) for the first one that is out of range, or that does not go with the method.
void check_settings(const RenderSettings& settings);

}  // namespace pelage
