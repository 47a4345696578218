// Painted preferences read from files. Values are compared with those of the second reader, or with
// what the test wrote.
#include "core/asset/painted.hpp"

#include <gmock/gmock.h>

#include "tests/asset/mesh_file_samples.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kU8 = 5121, kU16 = 5123, kF32 = 5126;

AssetOptions avoiding(const std::string& name) {
  AssetOptions options = kPlain;
  options.seam_avoid = name;
  return options;
}

Asset read_painted_file(const std::string& document, const std::string& name) {
  return read_file(document, avoiding(name));
}

std::vector<double> avoid_in(const std::string& document, const std::string& name) {
  return read_painted_file(document, name).surfaces().front().seam_avoid;
}

Error paint_refusal(const std::string& document, const std::string& name) {
  try {
    read_painted_file(document, name);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was refused";
  return {ErrorCode::internal, ""};
}

std::vector<double> painted_ramp(std::size_t count, double last) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i)
    values[i] = std::floor(last * static_cast<double>(i) / static_cast<double>(count - 1));
  return values;
}

/// A bent grid of 16 vertices with an attribute; normalised if its numbers are whole.
Builder grid_with(const std::string& name, const std::string& type, int component_type,
                  const std::vector<double>& values) {
  Builder b = grid(3);
  const std::size_t accessor = b.add(type, component_type, values);
  if (component_type != kF32) b.json["accessors"][accessor]["normalized"] = true;
  b.json["meshes"][0]["primitives"][0]["attributes"][name] = accessor;
  return b;
}

/// The value that the second reader finds at each corner, by `value` from the attribute's numbers.
template <class Value>
void expect_as_read_naively(const Builder& b, const std::string& name, const std::string& attribute,
                            const Value& value) {
  const Asset asset = read_painted_file(b.glb(), name);
  const Surface& surface = asset.surfaces().front();
  const std::vector<Face> faces = read_naively(b.glb())[0].faces;
  ASSERT_EQ(surface.seam_avoid.size(), surface.mesh.positions.size());
  for (std::size_t t = 0; t < faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(surface.seam_avoid[static_cast<std::size_t>(surface.mesh.faces[t][i])],
                  value(faces[t].at(attribute)[i]), 1e-6);
  EXPECT_TRUE(surface.texel_density.empty());
}

using Numbers = std::vector<double>;

TEST(Painted, ReadsANumberAChannelAndAColour) {
  Numbers shares = painted_ramp(16, 255);
  for (double& value : shares) value /= 255;
  expect_as_read_naively(grid_with("_AVOID", "SCALAR", kF32, shares), "_AVOID", "_AVOID",
                         [](const Numbers& n) { return n[0]; });
  const Builder colours = grid_with("COLOR_0", "VEC4", kU8, painted_ramp(64, 255));
  for (const std::size_t channel : {0U, 1U, 2U, 3U})
    expect_as_read_naively(colours, std::string("COLOR_0.") + "rgba"[channel], "COLOR_0",
                           [&](const Numbers& n) { return n[channel]; });
  expect_as_read_naively(colours, "COLOR_0", "COLOR_0",
                         [](const Numbers& n) { return (n[0] + n[1] + n[2]) / 3; });
  expect_as_read_naively(grid_with("COLOR_0", "VEC3", kU16, painted_ramp(48, 65535)), "COLOR_0.g",
                         "COLOR_0", [](const Numbers& n) { return n[1]; });
}

TEST(Painted, ReadsNothingUnlessAsked) {
  const Asset asset = read_file(grid_with("_AVOID", "SCALAR", kF32, Numbers(16, 1)).glb());
  EXPECT_THAT(asset.surfaces().front().seam_avoid, IsEmpty());
}

TEST(Painted, FillsTheFieldThatTheOptionNames) {
  AssetOptions options = kPlain;
  options.texel_density = "_DENSE";
  const Asset asset =
      read_file(grid_with("_DENSE", "SCALAR", kF32, Numbers(16, 0.5)).glb(), options);
  EXPECT_THAT(asset.surfaces().front().texel_density, Each(0.5));
  EXPECT_THAT(asset.surfaces().front().seam_avoid, IsEmpty());
}

TEST(Painted, TakesTheNearerEndForValuesBeyond) {
  Numbers values(16, 0.25);
  values[0] = -3, values[1] = 7;
  const std::vector<double> read = avoid_in(grid_with("_A", "SCALAR", kF32, values).glb(), "_A");
  EXPECT_EQ(read[0], 0);
  EXPECT_EQ(read[1], 1);
  EXPECT_EQ(read[2], 0.25);
}

TEST(Painted, TakesAnAttributeWhoseNameEndsLikeAChannel) {
  EXPECT_THAT(avoid_in(grid_with("_A.r", "SCALAR", kF32, Numbers(16, 0.5)).glb(), "_A.r"),
              Each(0.5));
}

TEST(Painted, LeavesSurfacesWithoutTheAttributeUnpainted) {
  Builder b = grid_with("_A", "SCALAR", kF32, Numbers(16, 0.5));
  Json bare = b.json["meshes"][0];
  bare["primitives"][0]["attributes"].erase("_A");
  bare["primitives"][0]["attributes"]["POSITION"] =
      b.add("VEC3", kF32, painted_ramp(48, 100));  // not the same geometry
  b.json["meshes"].push_back(bare);
  b.json["nodes"].push_back({{"mesh", 1}});
  const Asset asset = read_painted_file(b.glb(), "_A");
  ASSERT_EQ(asset.surfaces().size(), 2U);
  EXPECT_THAT(asset.surfaces()[0].seam_avoid, Each(0.5));
  EXPECT_THAT(asset.surfaces()[1].seam_avoid, IsEmpty());
}

TEST(Painted, ReadsWhatDracoAndMeshoptHaveCompressed) {
  const std::string plain = grid_with("_A", "SCALAR", kF32, Numbers(16, 0.5)).glb();
  for (const Compression compression : {Compression::draco, Compression::meshopt}) {
    const Asset asset = read_file(plain, {.compression = compression});
    const std::string packed = write(asset, split_nowhere(asset), Format::glb);
    EXPECT_THAT(avoid_in(packed, "_A"), Each(0.5));
  }
}

TEST(Painted, TellsWhichAttributesThereAre) {
  const Builder b = grid_with("_OTHER", "SCALAR", kF32, Numbers(16, 0.5));
  const Error error = paint_refusal(b.glb(), "_AVOID");
  EXPECT_EQ(error.code(), ErrorCode::invalid_option);
  EXPECT_EQ(error.where(), "/seam_avoid");
  EXPECT_THAT(error.what(), HasSubstr("\"_AVOID\"; they have POSITION, _OTHER"));
  AssetOptions density = kPlain;
  density.texel_density = "_AVOID";
  try {
    read_file(b.glb(), density);
    ADD_FAILURE();
  } catch (const Error& other) {
    EXPECT_EQ(other.where(), "/texel_density");
  }
}

TEST(Painted, RefusesTypesWithoutASingleValueInWords) {
  const Error pair = paint_refusal(grid_with("_A", "VEC2", kF32, Numbers(32, 0.5)).glb(), "_A");
  EXPECT_EQ(pair.code(), ErrorCode::invalid_option);
  EXPECT_THAT(pair.what(), HasSubstr("\"_A\" has 2 components; name a number (SCALAR)"));
  EXPECT_THAT(paint_refusal(grid_with("_A", "SCALAR", kF32, Numbers(16, 0.5)).glb(), "_A.g").what(),
              HasSubstr("has no such channel; it has 1 component"));
  EXPECT_THAT(paint_refusal(grid_with("_A", "VEC3", kF32, Numbers(48, 0.5)).glb(), "_A.a").what(),
              HasSubstr("has no such channel; it has 3 components"));
}

TEST(Painted, ReadsTheColoursOfAnObj) {
  const std::string file =
      "# v 9 9 9 1 1 1\n"
      "v 0 0 0 1 0.5 0\r\n"
      "v 1 0 0 0 0 \\\n0.75\n"
      "v 0 1 0 2 nan -1 # beyond\n"
      "v 1 1 0\n"
      "v 2 2 0 0.5\n"
      "f 1 2 3\nf 3 2 4\nf 4 2 5\n";
  EXPECT_THAT(avoid_in(file, "COLOR_0.r"), ElementsAre(1, 0, 1, 0, 0));
  EXPECT_THAT(avoid_in(file, "COLOR_0.b"), ElementsAre(0, 0.75, 0, 0, 0));
  EXPECT_THAT(avoid_in(file, "COLOR_0"), ElementsAre(0.5, 0.25, 0, 0, 0));
}

TEST(Painted, CountsBytesAndSharesAlikeInEveryFormat) {
  const std::string faces = "f 1 2 3\n", face = "3 0 1 2\n";
  for (const std::string& file :
       {"v 0 0 0 1 .6 0\nv 1 0 0 .2 0 0\nv 0 1 0 0 0 0\n" + faces,
        "v 0 0 0 255 153 0\nv 1 0 0 51 0 0\nv 0 1 0 0 0 0\n" + faces,
        "COFF\n3 1 0\n0 0 0 255 153 0 255\n1 0 0 51 0 0 255\n0 1 0 0 0 0 255\n" + face})
    EXPECT_THAT(avoid_in(file, "COLOR_0.r"), ElementsAre(1, testing::DoubleNear(0.2, 1e-6), 0))
        << file;
}

TEST(Painted, RefusesWhatAnObjLacks) {
  const std::string bare = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_THAT(paint_refusal(bare, "COLOR_0").what(), HasSubstr("they have none"));
  const std::string coloured = "v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n";
  EXPECT_THAT(paint_refusal(coloured, "_AVOID").what(), HasSubstr("they have COLOR_0"));
  EXPECT_THAT(paint_refusal(coloured, "COLOR_0.a").what(),
              HasSubstr("\"COLOR_0.a\"; they have COLOR_0"));
}

TEST(Painted, ReadsColoursAndOtherPropertiesOfAPly) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement camera 1\nproperty list uchar int views\n"
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string file =
      head + "2 7 8\n0 0 0 255 0 51 0.25\n1 0 0 0 0 0 2\n0 1 0 51 51 51 0\n3 0 1 2\n";
  const auto near = [](double value) { return testing::DoubleNear(value, 1e-7); };
  EXPECT_THAT(avoid_in(file, "COLOR_0.r"), ElementsAre(1, 0, near(0.2)));
  EXPECT_THAT(avoid_in(file, "COLOR_0"), ElementsAre(near(0.4), 0, near(0.2)));
  EXPECT_THAT(avoid_in(file, "quality"), ElementsAre(0.25, 1, 0));
  EXPECT_THAT(paint_refusal(file, "_A").what(), HasSubstr("they have x, y, z, red"));
  EXPECT_THAT(paint_refusal(file, "COLOR_0.a").what(), HasSubstr("they have COLOR_0"));
}

TEST(Painted, ReadsBinaryPlyOfEitherByteOrder) {
  for (const bool big : {false, true}) {
    std::string file = "ply\nformat binary_" + std::string(big ? "big" : "little") +
                       "_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                       "property float z\nproperty ushort avoid\nelement face 1\n"
                       "property list uchar uchar vertex_indices\nend_header\n";
    for (const int v : {0, 1, 2}) {
      for (const float x : {static_cast<float>(v == 1), static_cast<float>(v == 2), 0.0F})
        file += bytes(x, big);
      file += bytes(static_cast<std::uint16_t>(v * 13107), big);
    }
    file += std::string("\x03\x00\x01\x02", 4);
    EXPECT_THAT(avoid_in(file, "avoid"), ElementsAre(0, 0.2, 0.4)) << big;
  }
}

TEST(Painted, IsRefusedForFormatsThatAreReadWithoutAttributes) {
  const Error error = paint_refusal(cube_stl(), "COLOR_0");
  EXPECT_EQ(error.code(), ErrorCode::invalid_option);
  EXPECT_EQ(error.where(), "/seam_avoid");
  EXPECT_THAT(error.what(), HasSubstr("leave out seam_avoid"));
}

TEST(Painted, LeavesTheAnswerAsItIsButForSeams) {
  const Builder b = grid_with("_A", "SCALAR", kF32, Numbers(16, 0.5));
  const Asset plain = read_file(b.glb()), painted = read_painted_file(b.glb(), "_A");
  EXPECT_EQ(write(plain, split_nowhere(plain), Format::glb),
            write(painted, split_nowhere(painted), Format::glb));
}

}  // namespace
}  // namespace unwrapd::asset::test
