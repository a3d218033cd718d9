// The anti-aliasing methods: which frames a picture is made of.
#pragma once

#include <pelage/image.h>

#include "frame/one_frame.h"

namespace pelage {

/// The picture of `inputs.scene` that its settings' method makes: R, G, B, A, linear, premultiplied.
Image render_beauty(FrameInputs& inputs, Stages& stages);

}  // namespace pelage
