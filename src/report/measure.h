// The pictures of one case, measured against its reference.
#pragma once

#include <pelage/image.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "report/cases.h"

namespace pelage::report {

/// A metric as the report shows it.
struct Column {
  std::string key, label, about;
  bool higher_is_better = false;
};

/// The metrics of the library, the one that a reader looks at first in front, then those that `cases` tells of.
std::vector<Column> columns(const Cases& cases);

/// One number a column, infinite where two pictures are equal, none where it cannot be had.
using Numbers = std::vector<std::optional<double>>;

/// What is known of one picture beside the reference. All are empty for the reference itself.
struct Measurement {
  Numbers whole;  ///< over the whole picture
  Numbers hair;   ///< over the hair pixels; empty where no mask is known
};

/// A case in numbers.
struct CaseNumbers {
  int width = 0, height = 0;
  std::uint64_t hair_pixels = 0;     ///< 0 where no mask is known
  std::vector<Measurement> entries;  ///< in the order of Case::images
};

/// A case in numbers and pictures.
struct MeasuredCase {
  CaseNumbers numbers;
  ToneMap tone_map = ToneMap::kAces;  ///< from `pictures` to a display
  std::vector<Image> pictures;        ///< scene-linear R, G, B after the exposure of the report; in the order of Case::images
  std::vector<Image> errors;          ///< perceived error of every pixel, 0…1, one channel; empty where there is none
};

/// Reads and compares. The hair pixels are those where the first channel of the case's mask is above 0, else the channel
/// `coverage` of the reference. Throws Error naming the case and the image.
MeasuredCase measure(const Cases& cases, const Case& c);

}  // namespace pelage::report
