#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "core/base/error.hpp"
#include "core/texture/codec.hpp"
#include "tests/core/texture/pictures.hpp"

namespace unwrapd::texture::test {
namespace {

ErrorCode code_of(const std::string& bytes) {
  const ImageFile file{bytes, "/images/0"};
  try {
    decode(file, head_of(file), {});
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), "/images/0");
    return error.code();
  }
  return ErrorCode::internal;
}

Image smooth(int width, int height, bool is_grey) {
  return picture(width, height, [&](int x, int y) {
    const int value = 255 * x / width;
    return is_grey ? Rgba{value, value, value, 255} : Rgba{value, 255 * y / height, 90, 255};
  });
}

Image read_back(const std::string& bytes, ImageHead& head) {
  const ImageFile file{bytes, ""};
  head = head_of(file);
  return decode(file, head, {});
}

TEST(Codec, PngAndLosslessWebpGiveBackEveryTexel) {
  for (const Codec codec : {Codec::png, Codec::webp})
    for (const bool has_alpha : {false, true}) {
      Image image = noise(33, 19);
      if (!has_alpha)
        for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
      ImageHead head{codec, 33, 19, has_alpha, false, true}, again;
      EXPECT_EQ(read_back(encode(image, head, {}), again).rgba, image.rgba);
      EXPECT_EQ(again.codec, codec);
      EXPECT_EQ(again.has_alpha, has_alpha);
      EXPECT_TRUE(again.is_lossless);
    }
}

TEST(Codec, APngOfSixteenBitsGivesBackEveryTexel) {
  for (const bool has_alpha : {false, true}) {
    Image image = deep_noise(33, 19);
    if (!has_alpha)
      for (std::size_t i = 3; i < image.deep.size(); i += 4) image.deep[i] = 0xffff;
    ImageHead head{Codec::png, 33, 19, has_alpha, false, true, true}, again;
    EXPECT_EQ(read_back(encode(image, head, {}), again).deep, image.deep);
    EXPECT_TRUE(again.is_deep);
  }
  Image grey = deep_noise(9, 5);
  for (std::size_t i = 0; i < grey.deep.size(); i += 4)
    grey.deep[i + 1] = grey.deep[i + 2] = grey.deep[i];
  ImageHead again;
  EXPECT_EQ(read_back(encode(grey, {Codec::png, 9, 5, true, true, true, true}, {}), again).deep,
            grey.deep);
  EXPECT_TRUE(again.is_grey);
}

TEST(Codec, GreyStaysGrey) {
  const Image image = smooth(20, 10, true);
  for (const Codec codec : {Codec::png, Codec::jpeg}) {
    ImageHead head{codec, 20, 10, false, true, codec == Codec::png}, again;
    const Image back = read_back(encode(image, head, {}), again);
    EXPECT_TRUE(again.is_grey);
    for (std::size_t i = 0; i < image.rgba.size(); ++i)
      EXPECT_NEAR(back.rgba[i], image.rgba[i], codec == Codec::png ? 0 : 4);
  }
}

TEST(Codec, LossyFilesAreClose) {
  const Image image = smooth(64, 48, false);
  for (const Codec codec : {Codec::jpeg, Codec::webp}) {
    ImageHead head{codec, 64, 48, false, false, false}, again;
    const Image back = read_back(encode(image, head, {}), again);
    EXPECT_FALSE(again.is_lossless);
    EXPECT_EQ(back.width, 64);
    EXPECT_EQ(back.height, 48);
    for (std::size_t i = 0; i < image.rgba.size(); ++i)
      EXPECT_NEAR(back.rgba[i], image.rgba[i], 10) << i;
  }
}

TEST(Codec, EveryCutOfAFileIsRefused) {
  const Image image = noise(16, 16);
  for (const Codec codec : {Codec::png, Codec::jpeg, Codec::webp}) {
    const std::string bytes = encode(image, {codec, 16, 16, false, false, false}, {});
    for (std::size_t size = 12; size + 12 < bytes.size(); size += 3) {
      const ErrorCode code = code_of(bytes.substr(0, size));
      EXPECT_TRUE(code == ErrorCode::malformed_image || code == ErrorCode::unsupported_image)
          << size << " of " << bytes.size();
    }
  }
}

TEST(Codec, AHugeImageIsRefusedByItsHead) {
  std::string png = encode(noise(4, 4), {Codec::png, 4, 4, false, false, true}, {});
  png.replace(16, 8, std::string("\x00\x01\x00\x00\x00\x01\x00\x00", 8));  // 65536 x 65536
  png.replace(29, 4, "\xe3\xe6\xa7\xb4");                                  // and its checksum
  EXPECT_EQ(code_of(png), ErrorCode::too_much_memory);
  const std::string jpeg = encode(noise(4, 4), {Codec::jpeg, 4, 4, false, false, false}, {});
  std::string large = jpeg;
  const std::size_t frame = jpeg.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  large.replace(frame + 5, 4, "\xff\xdc\xff\xdc");  // 65500 x 65500
  EXPECT_EQ(code_of(large), ErrorCode::too_much_memory);
}

TEST(Codec, OtherFormatsAreRefusedByName) {
  for (const auto& [bytes, name] :
       {std::pair<std::string, std::string>{"\xabKTX 20\xbb\r\n\x1a\n", "KTX2"},
        {std::string("\0\0\0\x1c", 4) + "ftypavif", "AVIF"},
        {"DDS |", "DDS"},
        {"GIF89a", "GIF"}}) {
    try {
      head_of({bytes, "/images/3"});
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::unsupported_image);
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
      EXPECT_EQ(error.where(), "/images/3");
    }
  }
  EXPECT_EQ(code_of(""), ErrorCode::unsupported_image);
  EXPECT_EQ(code_of("not an image"), ErrorCode::unsupported_image);
}

TEST(Codec, AStopEndsDecodingAndEncoding) {
  std::stop_source source;
  source.request_stop();
  for (const Codec codec : {Codec::png, Codec::jpeg, Codec::webp}) {
    const ImageHead head{codec, 64, 64, false, false, false};
    const std::string bytes = encode(noise(64, 64), head, {});
    const ImageFile file{bytes, ""};
    for (const auto& work :
         {std::function<void()>([&] { decode(file, head, source.get_token()); }),
          std::function<void()>([&] { encode(noise(64, 64), head, source.get_token()); })}) {
      try {
        work();
        FAIL();
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
      }
    }
  }
}

/// Under the address sanitizer: what an encoder holds in the middle of its work is freed once.
TEST(Codec, AStopEndsEncodingWhereverItComes) {
  const Image image = noise(1500, 1500);
  for (const Codec codec : {Codec::png, Codec::jpeg})
    for (const int ms : {2, 5, 10, 20, 40}) {
      std::stop_source source;
      std::jthread later([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(ms));
        source.request_stop();
      });
      try {
        EXPECT_FALSE(
            encode(image, {codec, 1500, 1500, false, false, false}, source.get_token()).empty());
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
      }
    }
}

}  // namespace
}  // namespace unwrapd::texture::test
