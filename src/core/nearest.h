// The name that somebody probably meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pelage {

/// Number of insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`, no place edited
/// twice (optimal string alignment). Letter case costs nothing. O(a·b).
int edit_distance(std::string_view a, std::string_view b);

/// The entry of `known` with the smallest edit_distance() to `name`, the first of several; "" when `known` is empty.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace pelage
