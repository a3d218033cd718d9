// JPEG files (textures come as such) through libjpeg, from memory.
#include <cstddef>  // libjpeg's header needs these two and does not include them
#include <cstdio>

#include <jerror.h>
#include <jpeglib.h>
#include <pelage/error.h>

#include <csetjmp>
#include <string>
#include <vector>

#include "io/image_formats.h"

namespace pelage::io {
namespace {

// What libjpeg's callbacks see. Trivial, because they leave by longjmp.
struct Failure {
  jpeg_error_mgr manager;  // first: libjpeg hands out its address
  jmp_buf back;
  char problem[JMSG_LENGTH_MAX];
};

[[noreturn]] void fail_over(j_common_ptr jpeg) {
  auto* const failure = reinterpret_cast<Failure*>(jpeg->err);
  failure->manager.format_message(jpeg, failure->problem);
  std::longjmp(failure->back, 1);
}

// A file that is cut is an error, which libjpeg would fill with gray. Other damage may be anywhere and is no news.
void judge_message(j_common_ptr jpeg, int level) {
  if (level < 0 && jpeg->err->msg_code == JWRN_JPEG_EOF) fail_over(jpeg);
}

class JpegReader {
 public:
  explicit JpegReader(const ByteSource& source) : source_(source), bytes_(source.read_all()) {
    jpeg_.err = jpeg_std_error(&failure_.manager);
    failure_.manager.error_exit = fail_over;
    failure_.manager.emit_message = judge_message;
    run([this] {
      jpeg_create_decompress(&jpeg_);
      jpeg_mem_src(&jpeg_, reinterpret_cast<const unsigned char*>(bytes_.data()), static_cast<unsigned long>(bytes_.size()));
      jpeg_read_header(&jpeg_, TRUE);
    });
  }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
  ~JpegReader() { jpeg_destroy_decompress(&jpeg_); }

  Image read() {
    const bool gray = jpeg_.num_components == 1;
    check_image_size(source_, jpeg_.image_width, jpeg_.image_height, gray ? 1 : 3);
    jpeg_.out_color_space = gray ? JCS_GRAYSCALE : JCS_RGB;
    Image image(static_cast<int>(jpeg_.image_width), static_cast<int>(jpeg_.image_height),
                gray ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"});
    std::vector<JSAMPLE> row(static_cast<std::size_t>(image.width) * image.channel_count());
    run([&] {
      jpeg_start_decompress(&jpeg_);
      for (int y = 0; y < image.height; ++y) {
        JSAMPROW rows[] = {row.data()};
        jpeg_read_scanlines(&jpeg_, rows, 1);
        for (std::size_t i = 0; i < row.size(); ++i) image.at(0, y)[i] = static_cast<float>(row[i]) / 255;
      }
      jpeg_finish_decompress(&jpeg_);
    });
    return image;
  }

 private:
  // Runs libjpeg's functions. Their errors come back here over frames that own nothing.
  template <class Calls>
  void run(const Calls& calls) {
    if (setjmp(failure_.back) == 0) return calls();
    jpeg_destroy_decompress(&jpeg_);  // a constructor that fails is not followed by a destructor; twice does no harm
    throw Error(source_.name(), "", failure_.problem, "the JPEG file is truncated or damaged");
  }

  const ByteSource& source_;
  std::vector<char> bytes_;
  Failure failure_{};
  jpeg_decompress_struct jpeg_{};
};

}  // namespace

Image read_jpeg(const ByteSource& source) { return JpegReader(source).read(); }

}  // namespace pelage::io
