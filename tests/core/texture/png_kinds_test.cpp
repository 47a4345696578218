// PNG files that our own writer does not make.
#include <gtest/gtest.h>
#include <png.h>

#include <functional>

#include "core/texture/codec.hpp"
#include "tests/core/texture/pictures.hpp"

namespace unwrapd::texture::test {
namespace {

constexpr int kSide = 9;

struct Kind {
  int type = PNG_COLOR_TYPE_RGB, bits = 8, interlace = PNG_INTERLACE_NONE;
  std::function<void(png_structp, png_infop)> prepare = [](png_structp, png_infop) {};
};

/// A square file whose row y is row(y).
std::string png_of(const Kind& kind, const std::function<std::vector<png_byte>(int)>& row) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  std::string bytes;
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, png_size_t size) {
        static_cast<std::string*>(png_get_io_ptr(p))
            ->append(reinterpret_cast<const char*>(data), size);
      },
      nullptr);
  png_set_IHDR(png, info, kSide, kSide, kind.bits, kind.type, kind.interlace,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  kind.prepare(png, info);
  png_write_info(png, info);
  std::vector<std::vector<png_byte>> rows;
  std::vector<png_bytep> pointers;
  for (int y = 0; y < kSide; ++y) rows.push_back(row(y));
  for (std::vector<png_byte>& r : rows) pointers.push_back(r.data());
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

Image read(const std::string& bytes, ImageHead& head) {
  const ImageFile file{bytes, ""};
  head = head_of(file);
  return decode(file, head, {});
}

TEST(PngKinds, SixteenBitsAreReadWhole) {
  const std::string bytes = png_of({.bits = 16}, [](int y) {
    std::vector<png_byte> row;
    for (int x = 0; x < kSide; ++x)
      for (const int value : {1000 * x + 100 * y, 65535, 200}) {
        row.push_back(static_cast<png_byte>(value >> 8));
        row.push_back(static_cast<png_byte>(value & 255));
      }
    return row;
  });
  ImageHead head;
  const Image image = read(bytes, head);
  ASSERT_TRUE(head.is_deep && image.is_deep());
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const std::uint16_t* texel = image.deep.data() + image.index(x, y);
      EXPECT_EQ(texel[0], 1000 * x + 100 * y);
      EXPECT_EQ(texel[1], 65535);
      EXPECT_EQ(texel[2], 200);
      EXPECT_EQ(texel[3], 65535);
    }
}

TEST(PngKinds, APaletteGivesItsColoursAndAlpha) {
  Kind palette{.type = PNG_COLOR_TYPE_PALETTE};
  palette.prepare = [](png_structp png, png_infop info) {
    const std::array<png_color, 2> colours = {{{10, 20, 30}, {200, 100, 50}}};
    const png_byte alpha = 77;
    png_set_PLTE(png, info, colours.data(), 2);
    png_set_tRNS(png, info, &alpha, 1, nullptr);
  };
  const std::string bytes = png_of(palette, [](int y) {
    std::vector<png_byte> row;
    for (int x = 0; x < kSide; ++x) row.push_back(static_cast<png_byte>((x + y) % 2));
    return row;
  });
  ImageHead head;
  const Image image = read(bytes, head);
  EXPECT_TRUE(head.has_alpha);
  EXPECT_FALSE(head.is_grey);
  EXPECT_EQ(at(image, 0, 0), (Rgba{10, 20, 30, 77}));
  EXPECT_EQ(at(image, 1, 0), (Rgba{200, 100, 50, 255}));
}

TEST(PngKinds, AnInterlacedGreyFileWithAGammaKeepsItsValues) {
  Kind kind{.type = PNG_COLOR_TYPE_GRAY, .interlace = PNG_INTERLACE_ADAM7};
  kind.prepare = [](png_structp png, png_infop info) { png_set_gAMA(png, info, 1.0); };
  const std::string bytes = png_of(kind, [](int y) {
    std::vector<png_byte> row;
    for (int x = 0; x < kSide; ++x) row.push_back(static_cast<png_byte>(20 * x + y));
    return row;
  });
  ImageHead head;
  const Image image = read(bytes, head);
  EXPECT_TRUE(head.is_grey);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      EXPECT_EQ(at(image, x, y), (Rgba{20 * x + y, 20 * x + y, 20 * x + y, 255}));
}

}  // namespace
}  // namespace unwrapd::texture::test
