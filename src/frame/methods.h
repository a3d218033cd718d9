// The anti-aliasing methods: which frames a picture is made of, and what is done to them.
#pragma once

#include <pelage/image.h>

#include <cstdint>
#include <memory>

#include "frame/deferred_frame.h"
#include "frame/one_frame.h"

namespace pelage {

class TaaHistory;

/// What goes on from picture to picture of a sequence.
struct MethodState {
  MethodState();
  ~MethodState();
  MethodState(MethodState&&) noexcept;
  MethodState& operator=(MethodState&&) noexcept;

  std::unique_ptr<TaaHistory> history;  ///< null before the first picture
  std::uint32_t next_frame = 0;         ///< place in the sequence of jitters
  DeferredGrooms grooms;                ///< of method swr, prepared once
};

/// The same picture for further work and for a display, as in RenderResult.
struct Beauty {
  Image linear, display;
};

/// The picture of `inputs.scene` that its settings' method makes. Throws Error where the build lacks the method.
Beauty render_beauty(const FrameInputs& inputs, MethodState& state, Stages& stages);

}  // namespace pelage
