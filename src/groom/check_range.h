// Settings of what is made from a seed.
#pragma once

#include <pelage/error.h>

#include <fmt/format.h>

#include <type_traits>

namespace pelage::groom {

/// Throws an Error that names the setting unless it lies in low … high. Compared in the value's own type: the float nearest to 0.05 lies inside
/// a range that ends there.
template <class T>
void check_range(const char* name, T value, std::type_identity_t<T> low, std::type_identity_t<T> high) {
  if (!(value >= low && value <= high))
    throw Error("grow", name, fmt::format("{} is outside {} … {}", value, low, high), "choose a value in that range");
}

}  // namespace pelage::groom
