// libpng leaves a failing call by a longjmp: no object with a destructor lives in a step that it
// may leave. Each row is a step, so that a stop can be an exception.
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>
#include <new>

#include "core/base/cancel.hpp"
#include "core/texture/codecs.hpp"

namespace unwrapd::texture {
namespace {

constexpr png_alloc_size_t kMaxChunkBytes = png_alloc_size_t{8} << 20;  // of a profile or a text
constexpr int kCompression = 6;
constexpr int kBits = 8, kDeepBits = 16;  // of a channel

/// False if libpng left the step.
template <class Step>
bool completes(png_structp png, const Step& step) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  step();
  return true;
}

void ignore(png_structp /*png*/, png_const_charp /*message*/) {}

[[noreturn]] void leave(png_structp png, png_const_charp /*message*/) { png_longjmp(png, 1); }

void take_bytes(png_structp png, png_bytep to, std::size_t count) {
  auto& rest = *static_cast<std::string_view*>(png_get_io_ptr(png));
  if (count > rest.size()) png_error(png, "the file ends early");
  std::memcpy(to, rest.data(), count);
  rest.remove_prefix(count);
}

class Reader {
 public:
  explicit Reader(const ImageFile& file) : Reader(file, file.bytes) {
    if (png_ == nullptr || info_ == nullptr) throw std::bad_alloc();
    require(completes(png_, [this] {
      png_set_read_fn(png_, &rest_, take_bytes);
      png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // head_of() tells which
      png_set_chunk_malloc_max(png_, kMaxChunkBytes);
      png_read_info(png_, info_);
    }));  // what throws here finds the object made, so that its destructor runs
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  [[nodiscard]] ImageHead head() const {
    const int type = png_get_color_type(png_, info_);
    return {.codec = Codec::png,
            .width = static_cast<int>(png_get_image_width(png_, info_)),
            .height = static_cast<int>(png_get_image_height(png_, info_)),
            .has_alpha = (type & PNG_COLOR_MASK_ALPHA) != 0 ||
                         png_get_valid(png_, info_, PNG_INFO_tRNS) != 0,
            .is_grey = (type & PNG_COLOR_MASK_COLOR) == 0,
            .is_deep = png_get_bit_depth(png_, info_) == kDeepBits};
  }

  Image image(const std::stop_token& stop) {
    int passes = 1;
    Image image = blank(head());
    require(completes(png_, [&] { passes = make_rgba(image.is_deep()); }));
    const std::size_t row_bytes = (image.is_deep() ? 8 : 4) * static_cast<std::size_t>(image.width);
    if (png_get_rowbytes(png_, info_) != row_bytes) refuse_broken(file_, "PNG");
    for (int pass = 0; pass < passes; ++pass)
      for (int y = 0; y < image.height; ++y) {
        throw_if_cancelled(stop);
        png_bytep row = image.is_deep()
                            ? reinterpret_cast<png_bytep>(image.deep.data() + image.index(0, y))
                            : image.rgba.data() + image.index(0, y);
        require(completes(png_, [&] { png_read_row(png_, row, nullptr); }));
      }
    return image;
  }

 private:
  Reader(const ImageFile& file, std::string_view rest)
      : file_(file),
        rest_(rest),
        png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, leave, ignore)),
        info_(png_create_info_struct(png_)) {}

  void require(bool completed) const {
    if (!completed) refuse_broken(file_, "PNG");
  }

  /// Returns the number of passes of an interlaced image.
  int make_rgba(bool is_deep) {
    png_set_expand(png_);
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, is_deep ? 0xffff : 0xff, PNG_FILLER_AFTER);
    if (is_deep && std::endian::native == std::endian::little) png_set_swap(png_);
    const int passes = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return passes;
  }

  const ImageFile& file_;
  std::string_view rest_;
  png_structp png_;
  png_infop info_;
};

void append_bytes(png_structp png, png_bytep bytes, std::size_t count) {
  try {
    static_cast<std::string*>(png_get_io_ptr(png))
        ->append(reinterpret_cast<const char*>(bytes), count);
    return;
  } catch (const std::bad_alloc&) {  // must not pass through libpng
  }
  png_error(png, "out of memory");
}

class Writer {
 public:
  Writer()
      : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, leave, ignore)),
        info_(png_create_info_struct(png_)) {}
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { png_destroy_write_struct(&png_, &info_); }

  std::string write(const Image& image, const ImageHead& head, const std::stop_token& stop) {
    if (png_ == nullptr || info_ == nullptr) throw std::bad_alloc();
    const int type = (head.is_grey ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB) |
                     (head.has_alpha ? PNG_COLOR_MASK_ALPHA : 0);
    require(completes(png_, [&] { begin(image, type); }));
    if (image.is_deep())
      write_rows(image, image.deep, head, stop);
    else
      write_rows(image, image.rgba, head, stop);
    require(completes(png_, [&] { png_write_end(png_, info_); }));
    return std::move(bytes_);
  }

 private:
  static void require(bool completed) {
    if (!completed) throw Error(ErrorCode::internal, "A PNG image could not be written.");
  }

  /// values: those of the image.
  template <class Value>
  void write_rows(const Image& image, const std::vector<Value>& values, const ImageHead& head,
                  const std::stop_token& stop) {
    const std::size_t channels = (head.is_grey ? 1U : 3U) + (head.has_alpha ? 1U : 0U);
    std::vector<Value> row(channels * static_cast<std::size_t>(image.width));
    for (int y = 0; y < image.height; ++y) {
      throw_if_cancelled(stop);
      for (int x = 0; x < image.width; ++x)
        for (std::size_t c = 0; c < channels; ++c)
          row[channels * static_cast<std::size_t>(x) + c] =
              values[image.index(x, y) + (head.has_alpha && c + 1 == channels ? 3 : c)];
      require(
          completes(png_, [&] { png_write_row(png_, reinterpret_cast<png_bytep>(row.data())); }));
    }
  }

  void begin(const Image& image, int type) {
    png_set_write_fn(png_, &bytes_, append_bytes, nullptr);
    png_set_IHDR(png_, info_, static_cast<png_uint_32>(image.width),
                 static_cast<png_uint_32>(image.height), image.is_deep() ? kDeepBits : kBits, type,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(png_, kCompression);
    png_write_info(png_, info_);
    if (image.is_deep() && std::endian::native == std::endian::little) png_set_swap(png_);
  }

  std::string bytes_;
  png_structp png_;
  png_infop info_;
};

}  // namespace

ImageHead png_head(const ImageFile& file) { return Reader(file).head(); }

Image decode_png(const ImageFile& file, const ImageHead& /*head*/, const std::stop_token& stop) {
  return Reader(file).image(stop);
}

std::string encode_png(const Image& image, const ImageHead& head, const std::stop_token& stop) {
  return Writer().write(image, head, stop);
}

}  // namespace unwrapd::texture
