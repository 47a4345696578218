// libjpeg-turbo leaves a failing call by a longjmp: no object with a destructor lives in a step
// that it may leave. Its progress hook ends files of endless scans.
#include <cstdio>  // jpeglib.h needs it

#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>
#include <cstdlib>

#include "core/base/cancel.hpp"
#include "core/texture/codecs.hpp"

namespace unwrapd::texture {
namespace {

constexpr int kMaxScans = 500;  // of a progressive file; encoders write about ten

/// The error handler of one file, with the way out of a failing call.
struct Exit {
  jpeg_error_mgr errors;  // first: libjpeg knows the rest by it
  std::jmp_buf jump;
};

void leave(j_common_ptr info) { std::longjmp(reinterpret_cast<Exit*>(info->err)->jump, 1); }

/// Other warnings are about bytes that browsers ignore, too.
void leave_if_cut(j_common_ptr info, int level) {
  const int code = info->err->msg_code;
  if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER)) leave(info);
}

void prepare(Exit& exit) {
  jpeg_std_error(&exit.errors);
  exit.errors.error_exit = leave;
  exit.errors.emit_message = leave_if_cut;
}

/// False if libjpeg left the step.
template <class Step>
bool completes(Exit& exit, const Step& step) {
  if (setjmp(exit.jump) != 0) return false;
  step();
  return true;
}

struct Watch {
  jpeg_progress_mgr progress;  // first, as above
  const std::stop_token* stop;
};

void look(j_common_ptr info) {
  if (is_cancelled(*reinterpret_cast<Watch*>(info->progress)->stop)) leave(info);
  if (info->is_decompressor != 0 &&
      reinterpret_cast<j_decompress_ptr>(info)->input_scan_number > kMaxScans)
    leave(info);
}

Watch watch(const std::stop_token& stop) {
  Watch watch{};
  watch.progress.progress_monitor = look;
  watch.stop = &stop;
  return watch;
}

class Reader {
 public:
  explicit Reader(const ImageFile& file) : file_(file) {
    prepare(exit_);
    info_.err = &exit_.errors;
    const auto* bytes = reinterpret_cast<const unsigned char*>(file.bytes.data());
    const bool is_read = completes(exit_, [&] {
      jpeg_create_decompress(&info_);
      jpeg_mem_src(&info_, bytes, static_cast<unsigned long>(file_.bytes.size()));
      jpeg_read_header(&info_, TRUE);
    });
    if (!is_read) {
      jpeg_destroy_decompress(&info_);
      refuse_broken(file_, "JPEG");
    }
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { jpeg_destroy_decompress(&info_); }

  [[nodiscard]] ImageHead head() const {
    if (info_.num_components != 1 && info_.num_components != 3)
      throw Error(ErrorCode::unsupported_image,
                  "the JPEG image is neither grey nor of three channels (but CMYK, say), which "
                  "textures=transfer cannot resample; convert it to RGB",
                  file_.where);
    return {.codec = Codec::jpeg,
            .width = static_cast<int>(info_.image_width),
            .height = static_cast<int>(info_.image_height),
            .is_grey = info_.num_components == 1,
            .is_lossless = false};
  }

  Image image(const std::stop_token& stop) {
    Image image = blank(head());
    Watch hook = watch(stop);
    info_.progress = &hook.progress;
    info_.out_color_space = JCS_EXT_RGBA;
    const auto require = [&](bool completed) {
      throw_if_cancelled(stop);
      if (!completed) refuse_broken(file_, "JPEG");
    };
    require(completes(exit_, [&] { jpeg_start_decompress(&info_); }));
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW row = image.rgba.data() + 4 * static_cast<std::size_t>(info_.output_scanline) *
                                             static_cast<std::size_t>(image.width);
      require(completes(exit_, [&] { jpeg_read_scanlines(&info_, &row, 1); }));
    }
    return image;
  }

 private:
  const ImageFile& file_;
  Exit exit_{};
  jpeg_decompress_struct info_{};
};

class Writer {
 public:
  Writer() {
    prepare(exit_);
    info_.err = &exit_.errors;
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() {
    if (bytes_ != nullptr) info_.dest->term_destination(&info_);  // else it names a freed buffer
    jpeg_destroy_compress(&info_);
    std::free(bytes_);  // NOLINT(cppcoreguidelines-no-malloc): jpeg_mem_dest() allocates it
  }

  std::string write(const Image& image, bool is_grey, const std::stop_token& stop) {
    Watch hook = watch(stop);
    const auto require = [&](bool completed) {
      throw_if_cancelled(stop);
      if (!completed) throw Error(ErrorCode::internal, "A JPEG image could not be written.");
    };
    require(completes(exit_, [&] { begin(image, is_grey, hook); }));
    std::vector<std::uint8_t> row(static_cast<std::size_t>(image.width) * (is_grey ? 1 : 3));
    for (int y = 0; y < image.height; ++y) {
      fill(row, image, y, is_grey);
      JSAMPROW start = row.data();
      require(completes(exit_, [&] { jpeg_write_scanlines(&info_, &start, 1); }));
    }
    require(completes(exit_, [&] { jpeg_finish_compress(&info_); }));
    return {reinterpret_cast<const char*>(bytes_), size_};
  }

 private:
  void begin(const Image& image, bool is_grey, Watch& hook) {
    jpeg_create_compress(&info_);
    info_.progress = &hook.progress;
    jpeg_mem_dest(&info_, &bytes_, &size_);
    info_.image_width = static_cast<JDIMENSION>(image.width);
    info_.image_height = static_cast<JDIMENSION>(image.height);
    info_.input_components = is_grey ? 1 : 3;
    info_.in_color_space = is_grey ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&info_);
    jpeg_set_quality(&info_, kQuality, TRUE);
    info_.optimize_coding = TRUE;
    for (int c = 0; c < info_.num_components; ++c)  // no channel at a lower resolution
      info_.comp_info[c].h_samp_factor = info_.comp_info[c].v_samp_factor = 1;
    jpeg_start_compress(&info_, TRUE);
  }

  static void fill(std::vector<std::uint8_t>& row, const Image& image, int y, bool is_grey) {
    const std::size_t channels = is_grey ? 1 : 3;
    for (int x = 0; x < image.width; ++x)
      for (std::size_t c = 0; c < channels; ++c)
        row[channels * static_cast<std::size_t>(x) + c] = image.at(x, y)[c];
  }

  Exit exit_{};
  jpeg_compress_struct info_{};
  unsigned char* bytes_ = nullptr;
  unsigned long size_ = 0;
};

}  // namespace

ImageHead jpeg_head(const ImageFile& file) { return Reader(file).head(); }

Image decode_jpeg(const ImageFile& file, const ImageHead& /*head*/, const std::stop_token& stop) {
  return Reader(file).image(stop);
}

std::string encode_jpeg(const Image& image, const ImageHead& head, const std::stop_token& stop) {
  return Writer().write(image, head.is_grey, stop);
}

}  // namespace unwrapd::texture
