// Reading and writing look whether the job was told to stop.
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

template <class Work>
void expect_cancelled(Work work) {
  try {
    work();
    ADD_FAILURE() << "it went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
}

TEST(Cancel, IsHeardWhileEveryFormatIsReadAndWritten) {
  const std::string plain = grid(3).glb();
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto packed = [&](Compression compression) {
    const Asset asset = read_file(plain, {.compression = compression});
    return write(asset, split_everywhere(asset), Format::glb);
  };
  for (const std::string& file :
       {plain, obj, packed(Compression::draco), packed(Compression::meshopt)}) {
    std::stop_source source;
    const Asset asset = read({file, {}, source.get_token()}, {});
    source.request_stop();
    expect_cancelled([&] { read({file, {}, source.get_token()}, {}); });
    for (const Format format : {Format::glb, Format::gltf, Format::obj})
      expect_cancelled([&] { write(asset, split_everywhere(asset), format); });
  }
}

}  // namespace
}  // namespace unwrapd::asset::test
