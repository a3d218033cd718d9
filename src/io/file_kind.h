// Groom, hair mesh, mesh or image, told by content.
#pragma once

#include <string>

#include "io/byte_source.h"

namespace pelage::io {

enum class FileContent { kGroom, kHairMesh, kMesh, kImage };

struct FileKind {
  FileContent content = FileContent::kGroom;
  std::string format;  ///< "exr", "ply", "binary", …; empty for grooms, whose reader says it best
};

/// "exr", "png", "hdr" or "jpeg" by the first bytes; "" for anything else.
std::string image_format(const ByteSource& source);

/// Looks at the first bytes, and at the text for the faces that make an OBJ. What is neither mesh nor image counts as a
/// groom, whose reader explains what it tried.
FileKind file_kind(const ByteSource& source);

}  // namespace pelage::io
