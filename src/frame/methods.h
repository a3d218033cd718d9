// The anti-aliasing methods: which frames a picture is made of, and what is done to them.
#pragma once

#include <pelage/image.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "frame/deferred_frame.h"
#include "frame/one_frame.h"

namespace pelage {

class TaaHistory;

/// What goes on from picture to picture of a sequence, of one view.
struct MethodState {
  MethodState();
  ~MethodState();
  MethodState(MethodState&&) noexcept;
  MethodState& operator=(MethodState&&) noexcept;

  std::unique_ptr<TaaHistory> history;  ///< null before the first picture
  std::uint32_t next_frame = 0;         ///< place in the sequence of jitters
};

/// The same picture for further work and for a display, as in RenderResult.
struct Beauty {
  Image linear, display;
};

/// What each of `views` sees of their one scene, by the method of its settings: views of method swr share the strands of `grooms`,
/// others are made one after the other. states: one a view. Throws Error where the build lacks the method.
std::vector<Beauty> render_beauty(std::span<const FrameInputs> views, std::span<MethodState> states,
                                  const DeferredGrooms& grooms, Stages& stages);

}  // namespace pelage
