// Any bytes through the whole of asset: what can be read can be written in every format, and what
// was written can be read again. Draco's and meshopt's streams are also fuzzed bare, wrapped into a
// sound document, where a mutation of a whole file would seldom get past the container.
#include <draco/compression/expert_encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "core/asset/asset.hpp"
#include "core/base/error.hpp"
#include "tests/asset/mesh_file_samples.hpp"
#include "tests/fuzz/targets.hpp"

namespace unwrapd::fuzz {
namespace {

using Json = nlohmann::ordered_json;

constexpr asset::ReadLimits kLimits{.max_vertices = 20'000, .max_faces = 20'000};

/// Every second face gets vertices of its own.
UnwrappedSurface cut(const Surface& surface) {
  UnwrappedSurface result;
  result.faces = surface.mesh.faces;
  for (Index i = 0; i < surface.mesh.vertex_count(); ++i) result.source.push_back(i);
  for (std::size_t t = 0; t < result.faces.size(); t += 2)
    for (Index& corner : result.faces[t]) {
      result.source.push_back(corner);
      corner = static_cast<Index>(result.source.size() - 1);
    }
  result.uv.resize(result.source.size(), Vec2(0.25, 0.75));
  return result;
}

std::vector<UnwrappedSurface> cut_all(const asset::Asset& read) {
  std::vector<UnwrappedSurface> unwrapped;
  for (const Surface& surface : read.surfaces()) unwrapped.push_back(cut(surface));
  return unwrapped;
}

constexpr std::array kFormats = {asset::Format::glb, asset::Format::gltf, asset::Format::obj};

void whole_file(std::string_view bytes) {
  const asset::Asset read = asset::read({bytes, {}}, kLimits);
  const std::vector<UnwrappedSurface> unwrapped = cut_all(read);
  for (const asset::Format format : kFormats) {
    const std::string answer = asset::write(read, unwrapped, format);
    promise(!answer.empty(), "an answer has bytes");
    promise(!asset::read({answer, {}}, {}).surfaces().empty(), "our own answer is read again");
  }
}

/// The grid as it is written in a format.
std::string grid_as(asset::Format format, int n) {
  const std::string obj = grid_obj(n);
  const asset::Asset read = asset::read({obj, {}}, {});
  return asset::write(read, cut_all(read), format);
}

std::vector<std::string> gltf_seeds() {
  return {grid_as(asset::Format::glb, 2), grid_as(asset::Format::gltf, 1)};
}

std::vector<std::string> obj_seeds() {
  return {grid_obj(2), grid_as(asset::Format::obj, 1),
          "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\nf -1 -2 \\\n-3\n"};
}

std::vector<std::string> stl_seeds() {
  return {asset::test::cube_stl(), asset::test::cube_text_stl()};
}

std::vector<std::string> ply_seeds() {
  return {asset::test::cube_text_ply(), asset::test::cube_binary_ply(false),
          asset::test::cube_binary_ply(true),
          asset::test::strips_ply({0, 1, 3, 2, -1, 4, 5, 7}, false)};
}

std::vector<std::string> off_seeds() { return {asset::test::cube_off()}; }

/// A document whose one buffer is these bytes, as a data URI of hex would not be: base64.
std::string base64(std::string_view bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    for (int shift = 18; shift >= 0; shift -= 6) text += digits[group >> shift & 63U];
  }
  if (bytes.size() % 3 != 0)
    text.replace(text.size() - (3 - bytes.size() % 3), 2, "==", 3 - bytes.size() % 3);
  return text;
}

Json buffer_of(std::string_view bytes) {
  return {{"byteLength", bytes.size()},
          {"uri", "data:application/octet-stream;base64," + base64(bytes)}};
}

/// A bitstream in a document that claims nothing about it.
void draco_stream(std::string_view bytes) {
  Json json = {{"asset", {{"version", "2.0"}}}};
  json["extensionsRequired"] = json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  json["buffers"] = Json::array({buffer_of(bytes)});
  json["bufferViews"] = Json::array({{{"buffer", 0}, {"byteLength", bytes.size()}}});
  json["accessors"] = {{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}},
                       {{"componentType", 5125}, {"count", 3}, {"type", "SCALAR"}}};
  const Json extension = {{"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
  const Json primitive = {{"attributes", {{"POSITION", 0}}},
                          {"indices", 1},
                          {"extensions", {{"KHR_draco_mesh_compression", extension}}}};
  json["meshes"] = Json::array({{{"primitives", Json::array({primitive})}}});
  whole_file(json.dump());
}

std::string draco_of(const draco::Mesh& mesh, int method) {
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(method);
  if (method == draco::MESH_EDGEBREAKER_ENCODING) encoder.SetAttributeQuantization(0, 11);
  draco::EncoderBuffer buffer;
  promise(encoder.EncodeToBuffer(&buffer).ok(), "Draco writes the seed");
  return {buffer.data(), buffer.size()};
}

std::vector<std::string> draco_seeds() {
  const std::string obj = grid_obj(4);
  const asset::Asset read = asset::read({obj, {}}, {});
  const TriMesh& mesh = read.surfaces().front().mesh;
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(mesh.faces.size()));
  const int id = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    std::array<std::array<float, 3>, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 3; ++k)
        corners[c][k] = static_cast<float>(
            mesh.positions[static_cast<std::size_t>(mesh.faces[t][c])][static_cast<Index>(k)]);
    builder.SetAttributeValuesForFace(id, draco::FaceIndex(static_cast<std::uint32_t>(t)),
                                      corners[0].data(), corners[1].data(), corners[2].data());
  }
  const std::unique_ptr<draco::Mesh> soup = builder.Finalize();
  return {draco_of(*soup, draco::MESH_SEQUENTIAL_ENCODING),
          draco_of(*soup, draco::MESH_EDGEBREAKER_ENCODING)};
}

/// The first bytes choose mode, filter, stride and count; the rest is the stream.
void meshopt_stream(std::string_view bytes) {
  constexpr std::size_t kChoices = 4;
  constexpr std::array kModes = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
  constexpr std::array kFilters = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
  if (bytes.size() < kChoices) return;
  const auto choice = [&](std::size_t i) { return static_cast<std::uint8_t>(bytes[i]); };
  const std::size_t stride = choice(2) % 64;
  const std::size_t count = std::size_t{3} * choice(3);
  const std::string_view stream = bytes.substr(kChoices);
  const Json extension = {{"buffer", 0},
                          {"byteLength", stream.size()},
                          {"byteStride", stride},
                          {"count", count},
                          {"mode", kModes[choice(0) % kModes.size()]},
                          {"filter", kFilters[choice(1) % kFilters.size()]}};
  Json json = {{"asset", {{"version", "2.0"}}}};
  json["extensionsRequired"] = json["extensionsUsed"] = {"EXT_meshopt_compression"};
  json["buffers"] = Json::array({buffer_of(stream)});
  json["bufferViews"] = Json::array({{{"buffer", 0},
                                      {"byteLength", count * stride},
                                      {"byteStride", stride},
                                      {"extensions", {{"EXT_meshopt_compression", extension}}}}});
  json["accessors"] = Json::array(
      {{{"bufferView", 0}, {"componentType", 5126}, {"count", count}, {"type", "VEC3"}}});
  json["meshes"] =
      Json::array({{{"primitives", Json::array({{{"attributes", {{"POSITION", 0}}}}})}}});
  whole_file(json.dump());
}

std::vector<std::string> meshopt_seeds() {
  constexpr std::size_t kCount = 24;
  std::array<float, 3 * kCount> points{};
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = static_cast<float>(i * i % 29) / 8;
  std::vector<unsigned char> stream(meshopt_encodeVertexBufferBound(kCount, 12));
  stream.resize(
      meshopt_encodeVertexBuffer(stream.data(), stream.size(), points.data(), kCount, 12));
  const std::string bytes(stream.begin(), stream.end());
  const auto choices = [](char mode, char filter, char stride) {
    return std::string{mode, filter, stride, static_cast<char>(kCount / 3)};
  };
  return {choices(0, 0, 12) + bytes, choices(0, 3, 12) + bytes, choices(0, 1, 8) + bytes,
          choices(1, 0, 4) + bytes, choices(2, 0, 2) + bytes};
}

const std::array kTargets = {Target{"gltf", whole_file, gltf_seeds},
                             Target{"obj", whole_file, obj_seeds},
                             Target{"stl", whole_file, stl_seeds},
                             Target{"ply", whole_file, ply_seeds},
                             Target{"off", whole_file, off_seeds},
                             Target{"draco", draco_stream, draco_seeds},
                             Target{"meshopt", meshopt_stream, meshopt_seeds},
                             image_target()};

}  // namespace

std::span<const Target> asset_targets() { return kTargets; }

}  // namespace unwrapd::fuzz
