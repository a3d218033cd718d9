// What the mesh readers share.
#pragma once

#include <pelage/triangle_mesh.h>

#include <string>

#include "io/byte_source.h"

namespace pelage::io {

TriangleMesh read_obj(const ByteSource& source);

}  // namespace pelage::io
