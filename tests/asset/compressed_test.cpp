// Draco and meshopt: documents compressed here, by the libraries' own encoders.
#include <draco/compression/expert_encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <random>

#include "tests/asset/memory_guard.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

/// A wavy grid of 2 n^2 faces as a Draco bitstream with positions alone.
std::string draco_bitstream(int n, int method) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2 * n * n);
  const int position =
      builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const auto point = [](int i, int k) {
    return std::array<float, 3>{0.5F * static_cast<float>(i), 0.25F * static_cast<float>(k),
                                0.125F * static_cast<float>(i * k)};
  };
  std::uint32_t face = 0;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k)
      for (const int turn : {0, 1}) {
        const auto a = point(i, k);
        const auto b = turn == 0 ? point(i, k + 1) : point(i + 1, k + 1);
        const auto c = turn == 0 ? point(i + 1, k + 1) : point(i + 1, k);
        builder.SetAttributeValuesForFace(position, draco::FaceIndex(face++), a.data(), b.data(),
                                          c.data());
      }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::ExpertEncoder encoder(*mesh);
  encoder.SetEncodingMethod(method);
  if (method == draco::MESH_EDGEBREAKER_ENCODING) encoder.SetAttributeQuantization(0, 11);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  return {buffer.data(), buffer.size()};
}

/// A glTF around a bitstream. Counts are those of the grid; nothing else is known of the stream.
std::string wrapped(const std::string& bitstream, std::size_t points, std::size_t corners) {
  Builder b;
  const std::size_t view = b.add_view(bitstream);
  b.json["accessors"] = {{{"componentType", 5126}, {"count", points}, {"type", "VEC3"}},
                         {{"componentType", 5125}, {"count", corners}, {"type", "SCALAR"}}};
  b.add_primitive({{"POSITION", 0}}, 1)["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return b.glb();
}

TEST(Draco, ComesOutAsAPlainDocument) {
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const std::string file = wrapped(draco_bitstream(10, method), 121, 600);
    const Asset asset = read_file(file);
    ASSERT_EQ(asset.surfaces()[0].mesh.face_count(), 200);
    const std::string answer = write(asset, split_everywhere(asset), Format::glb);
    const Json document = json_of(answer);
    EXPECT_FALSE(document.contains("extensionsUsed"));
    EXPECT_FALSE(document.contains("extensionsRequired"));
    EXPECT_FALSE(document["meshes"][0]["primitives"][0].contains("extensions"));
    const Asset again = read_file(answer);
    EXPECT_EQ(again.surfaces()[0].mesh.face_count(), 200);
    const std::vector<ReadPrimitive> read = read_naively(answer);
    expect_same_but_uv(read, read);
  }
}

TEST(Draco, SequentialIsExact) {
  const Asset asset =
      read_file(wrapped(draco_bitstream(4, draco::MESH_SEQUENTIAL_ENCODING), 25, 96));
  const Asset plain = read_file(grid(4).glb());
  for (std::size_t t = 0; t < 32; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const TriMesh& a = asset.surfaces()[0].mesh;
      const TriMesh& b = plain.surfaces()[0].mesh;
      EXPECT_EQ(a.positions[static_cast<std::size_t>(a.faces[t][k])],
                b.positions[static_cast<std::size_t>(b.faces[t][k])]);
    }
}

TEST(Draco, SharedBitstreamsAreDecodedOnceAndFallbacksKept) {
  Builder b;
  const std::size_t fallback = b.add("VEC3", 5126, {0, 0, 0, 1, 0, 0, 0, 1, 0});
  const std::size_t view = b.add_view(draco_bitstream(4, draco::MESH_SEQUENTIAL_ENCODING));
  for (int i = 0; i < 1000; ++i)
    b.add_primitive({{"POSITION", fallback}})["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  b.add_primitive({{"POSITION", fallback}});
  b.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  const Asset asset = read_file(b.glb());
  EXPECT_EQ(asset.surfaces()[0].mesh.face_count(), 33);
  const std::string answer = write(asset, split_everywhere(asset), Format::glb);
  const std::vector<ReadPrimitive> read = read_naively(answer);
  EXPECT_EQ(read[0].faces.size(), 32U);
  EXPECT_EQ(points_of(read[1000].faces[0])[1], Vec3(1, 0, 0));
}

TEST(Draco, EveryPrefixAndManyFlippedBytesAreReadOrRefused) {
  std::mt19937 random(7);
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const std::string good = draco_bitstream(6, method);
    for (std::size_t length = 0; length < good.size(); ++length)
      EXPECT_EQ(error_of(wrapped(good.substr(0, length), 49, 216)).code(),
                ErrorCode::malformed_draco);
    for (int k = 0; k < 2000; ++k) {
      std::string bad = good;
      for (int flips = 0; flips <= k % 3; ++flips)
        bad[random() % bad.size()] = static_cast<char>(random());
      try {
        read_file(wrapped(bad, 49, 216));
      } catch (const Error& error) {
        EXPECT_NE(error.code(), ErrorCode::internal);
      }
    }
  }
}

std::string varint(std::uint32_t value) {
  std::string bytes;
  for (; value > 127; value >>= 7) bytes += static_cast<char>((value & 127) | 128);
  return bytes + static_cast<char>(value);
}

TEST(Draco, WhatABitstreamClaimsIsJudgedBeforeMemoryIsTakenForIt) {
  constexpr std::size_t header = 11;
  const std::string sequential = draco_bitstream(3, draco::MESH_SEQUENTIAL_ENCODING);
  ASSERT_EQ(sequential[header], 18);      // faces
  ASSERT_EQ(sequential[header + 1], 16);  // points
  ASSERT_EQ(sequential[header + 2], 1);   // indices follow, a byte each
  std::string wide;  // the same indices in the 32 bits that so many points would give them
  for (std::size_t i = 0; i < 54; ++i) wide += sequential[header + 3 + i] + std::string(3, '\0');
  const std::string edgebreaker = draco_bitstream(3, draco::MESH_EDGEBREAKER_ENCODING);
  const std::vector<std::string> claims = {
      sequential.substr(0, header + 1) + varint(9'000'000) + '\1' + wide +
          sequential.substr(header + 57),
      sequential.substr(0, header + 1) + varint(9'000'000) + sequential.substr(header + 2),
      sequential.substr(0, header) + varint(9'000'000) + sequential.substr(header + 1),
      edgebreaker.substr(0, header + 1) + varint(30'000) + varint(15'000'000) + '\0' +
          varint(15'000'000) + varint(0) + edgebreaker.substr(header + 6)};
  for (const std::string& claim : claims) {
    const std::string file = wrapped(claim, 16, 54);
    const MemoryPeak peak;
    EXPECT_EQ(error_of(file).code(), ErrorCode::malformed_draco);
    EXPECT_LT(peak.bytes(), std::size_t{8} << 20);
  }
}

TEST(Draco, APointCloudAndAForeignAttributeAreRefused) {
  std::string cloud = draco_bitstream(3, draco::MESH_SEQUENTIAL_ENCODING);
  cloud[7] = 0;  // the encoder's type
  EXPECT_EQ(error_of(wrapped(cloud, 16, 54)).code(), ErrorCode::malformed_draco);
  std::string file = wrapped(draco_bitstream(3, draco::MESH_SEQUENTIAL_ENCODING), 16, 54);
  const std::size_t at = file.find("\"attributes\":{\"POSITION\":0}}");
  file.replace(file.find("\"POSITION\":0}}", at), 14, "\"POSITION\":9}}");
  EXPECT_EQ(error_of(file).code(), ErrorCode::malformed_draco);
}

TEST(Draco, BooleansAreRefused) {
  std::string bools = draco_bitstream(3, draco::MESH_SEQUENTIAL_ENCODING);
  constexpr std::size_t type =
      11 + 57 + 3;  // after the header, the faces and what attributes there are
  ASSERT_EQ(bools[type], draco::DT_FLOAT32);
  bools[type] = draco::DT_BOOL;
  EXPECT_EQ(error_of(wrapped(bools, 16, 54)).code(), ErrorCode::malformed_draco);
}

/// The grid with every view compressed; the uncompressed bytes are nowhere.
Builder meshopt_grid(int n, const std::string& name) {
  Builder b = grid(n);
  Builder packed = b;
  packed.bin.clear();
  const std::string positions = b.bin.substr(0, static_cast<std::size_t>((n + 1) * (n + 1)) * 12);
  const std::string corners = b.bin.substr(positions.size());
  std::vector<unsigned char> stream(meshopt_encodeVertexBufferBound(positions.size() / 12, 12));
  stream.resize(meshopt_encodeVertexBuffer(stream.data(), stream.size(), positions.data(),
                                           positions.size() / 12, 12));
  packed.bin.assign(stream.begin(), stream.end());
  const auto set = [&](std::size_t view, std::size_t offset, std::size_t length,
                       const std::string& mode, std::size_t stride, std::size_t count) {
    Json& json = packed.json["bufferViews"][view];
    json["buffer"] = 1;
    json["extensions"][name] = {{"buffer", 0},          {"byteOffset", offset},
                                {"byteLength", length}, {"byteStride", stride},
                                {"mode", mode},         {"count", count}};
  };
  set(0, 0, packed.bin.size(), "ATTRIBUTES", 12, positions.size() / 12);
  packed.bin.resize((packed.bin.size() + 3) / 4 * 4);
  const auto* indices = reinterpret_cast<const unsigned*>(corners.data());
  const std::size_t count = corners.size() / 4;
  std::vector<unsigned char> faces(meshopt_encodeIndexBufferBound(count, positions.size() / 12));
  faces.resize(meshopt_encodeIndexBuffer(faces.data(), faces.size(), indices, count));
  set(1, packed.bin.size(), faces.size(), "TRIANGLES", 4, count);
  packed.bin.append(faces.begin(), faces.end());
  packed.json["buffers"].push_back(
      {{"byteLength", b.bin.size()}, {"extensions", {{name, {{"fallback", true}}}}}});
  packed.json["extensionsUsed"] = packed.json["extensionsRequired"] = {name};
  return packed;
}

TEST(Meshopt, ComesOutAsAPlainDocument) {
  for (const std::string name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const Asset asset = read_file(meshopt_grid(20, name).glb());
    const Asset plain = read_file(grid(20).glb());
    EXPECT_EQ(asset.surfaces()[0].mesh.positions, plain.surfaces()[0].mesh.positions);
    const std::string answer = write(asset, split_everywhere(asset), Format::glb);
    const Json document = json_of(answer);
    EXPECT_EQ(answer.find("meshopt"), std::string::npos);
    EXPECT_EQ(document["buffers"].size(), 1U);
    const std::vector<ReadPrimitive> read = read_naively(answer);
    EXPECT_EQ(read[0].faces.size(), 800U);
    expect_same_but_uv(read, read);
  }
}

TEST(Meshopt, ClaimsAndModesAreCheckedBeforeDecoding) {
  const std::string name = "EXT_meshopt_compression";
  const std::vector<std::pair<std::string, Json>> faults = {
      {"count", 1000000000}, {"count", 440},    {"byteStride", 0},    {"byteStride", 6},
      {"byteStride", 260},   {"mode", "INDEX"}, {"mode", "INDICES"},  {"mode", "TRIANGLES"},
      {"filter", "SEPIA"},   {"buffer", 7},     {"byteLength", 99999}};
  for (const auto& [key, value] : faults) {
    Builder b = meshopt_grid(20, name);
    b.json["bufferViews"][0]["extensions"][name][key] = value;
    const Error error = error_of(b.glb());
    EXPECT_TRUE(error.where().starts_with("/bufferViews/0/extensions/" + name)) << key << value;
  }
}

TEST(Meshopt, ANewerStreamIsNamedAsUnsupported) {
  Builder b = meshopt_grid(4, "KHR_meshopt_compression");
  b.bin[0] = static_cast<char>(0xa1);
  EXPECT_EQ(error_of(b.glb()).code(), ErrorCode::unsupported_extension);
}

TEST(Meshopt, FlippedBytesAndPrefixesAreReadOrRefused) {
  std::mt19937 random(11);
  const Builder good = meshopt_grid(20, "EXT_meshopt_compression");
  for (int k = 0; k < 2000; ++k) {
    Builder bad = good;
    bad.bin[random() % bad.bin.size()] = static_cast<char>(random());
    try {
      read_file(bad.glb());
    } catch (const Error& error) {
      EXPECT_NE(error.code(), ErrorCode::internal);
    }
  }
  const std::string key = "EXT_meshopt_compression";
  const std::size_t length = good.json["bufferViews"][0]["extensions"][key]["byteLength"];
  for (std::size_t n = 0; n < length; ++n) {
    Builder cut = good;
    cut.json["bufferViews"][0]["extensions"][key]["byteLength"] = n;
    EXPECT_EQ(error_of(cut.glb()).code(), ErrorCode::malformed_meshopt) << n;
  }
}

}  // namespace
}  // namespace unwrapd::asset::test
