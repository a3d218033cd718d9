// Everything public at once.
#pragma once

#include <pelage/animation.h>
#include <pelage/denoise.h>
#include <pelage/error.h>
#include <pelage/grow.h>
#include <pelage/hair_mesh.h>
#include <pelage/hair_mesh_fit.h>
#include <pelage/hair_mesh_styles.h>
#include <pelage/image.h>
#include <pelage/io.h>
#include <pelage/knit.h>
#include <pelage/lod.h>
#include <pelage/metrics.h>
#include <pelage/progress.h>
#include <pelage/render.h>
#include <pelage/runtime.h>
#include <pelage/scene.h>
#include <pelage/simulate.h>
#include <pelage/strand_set.h>
#include <pelage/trace.h>
#include <pelage/triangle_mesh.h>
#include <pelage/vec.h>
