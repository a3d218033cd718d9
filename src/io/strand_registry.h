// The groom formats. A format is one file that defines a `const StrandFormat` and one line in strand_registry.cpp.
#pragma once

#include <pelage/io.h>

#include <optional>
#include <string>
#include <vector>

#include "io/atomic_file.h"
#include "io/byte_source.h"

namespace pelage::io {

/// What a reader found, still in the units and axes of the file; place_strands() makes metres and Y up of it.
struct FileStrands {
  StrandSet strands;               ///< widths empty: the file has none
  float scale = 0;                 ///< metres per unit where the file says so, else 0
  UpAxis up = UpAxis::kY;          ///< what the file says, or the habit of the format
  bool up_stated = false;          ///< the file says so
  bool up_varies = false;          ///< files of this format come with either axis up: look at the strands
  bool width_is_fallback = false;  ///< the one width is a header's default that exporters leave unset
  std::vector<std::string> notes;
};

struct StrandFormat {
  FormatInfo info;
  /// Empty when the bytes are of this format (a truncated file counts), else one clause why not.
  std::string (*mismatch)(const ByteSource& source);
  /// Sizes are checked against the source before anything is allocated; throws Error naming the place.
  /// Fills a valid partition into offsets; any content of the other arrays is left to repair().
  FileStrands (*read)(const ByteSource& source, const Progress& progress);
  /// Returns a sentence for each attribute that does not fit. The caller commits the file.
  std::vector<std::string> (*write)(AtomicFile& file, const StrandSet& strands, const Progress& progress);
};

/// In the order in which content is tried: formats with a magic number first.
const std::vector<const StrandFormat*>& strand_registry();

/// The format of the bytes. Throws Error listing what was tried and why not, or naming a known foreign format.
const StrandFormat& detect_strand_format(const ByteSource& source);

/// What read_strands() does with bytes that are already in memory (tests, fuzzing).
StrandSet read_strands(const ByteSource& source, const ImportOptions& options, ImportReport* report,
                       const Progress& progress = {});

}  // namespace pelage::io
