// Supersampling: the mean of frames, each of which took one sample of every pixel.
#pragma once

#include <pelage/image.h>

namespace pelage {

/// Adds frames up and keeps nothing but their sum: the memory of one frame for any number of them.
class FrameMean {
 public:
  /// The first frame decides size and channels. The sum is that of the frames in their order, for any number of threads.
  void add(Image frame);
  int count() const { return count_; }
  /// The mean: a box filter over the pixel where the frames' samples fill it. Needs one frame at least.
  Image take();

 private:
  Image sum_;
  int count_ = 0;
};

}  // namespace pelage
