#include "tests/asset/support.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "tests/samples/test_data.hpp"

namespace unwrapd::asset::test {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string base64(const std::string& bytes) {
  std::string text;
  unsigned bits = 0;
  int count = 0;
  for (const char c : bytes) {
    bits = (bits << 8 | static_cast<unsigned char>(c)) & 0xffffff;
    for (count += 8; count >= 6; count -= 6) text += kDigits[bits >> (count - 6) & 63];
  }
  if (count > 0) text += kDigits[bits << (6 - count) & 63];
  while (text.size() % 4 != 0) text += '=';
  return text;
}

template <class T>
void put(std::string& bytes, double number) {
  const T value = static_cast<T>(number);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put(std::string& bytes, int component_type, double number) {
  if (component_type == 5120) return put<std::int8_t>(bytes, number);
  if (component_type == 5121) return put<std::uint8_t>(bytes, number);
  if (component_type == 5122) return put<std::int16_t>(bytes, number);
  if (component_type == 5123) return put<std::uint16_t>(bytes, number);
  if (component_type == 5125) return put<std::uint32_t>(bytes, number);
  return put<float>(bytes, number);
}

std::uint64_t mixed(std::uint64_t x) {
  x ^= x >> 31;
  x *= 0x9e3779b97f4a7c15;
  x ^= x >> 29;
  return x * 0xbf58476d1ce4e5b9;
}

std::uint64_t hash_of(const Vec3& point) {
  std::uint64_t hash = 1;
  for (int k = 0; k < 3; ++k) hash = mixed(hash ^ std::bit_cast<std::uint64_t>(point[k] + 0.0));
  return hash;
}

}  // namespace

std::size_t Builder::add_view(const std::string& bytes) {
  bin.resize((bin.size() + 3) / 4 * 4);
  json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}});
  bin += bytes;
  return json["bufferViews"].size() - 1;
}

std::size_t Builder::add(const std::string& type, int component_type,
                         const std::vector<double>& values) {
  const std::map<std::string, std::size_t> sizes = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  std::string bytes;
  for (const double value : values) put(bytes, component_type, value);
  const std::size_t view = add_view(bytes);
  json["accessors"].push_back({{"bufferView", view},
                               {"componentType", component_type},
                               {"count", values.size() / sizes.at(type)},
                               {"type", type}});
  return json["accessors"].size() - 1;
}

Json& Builder::add_primitive(const std::map<std::string, std::size_t>& attributes,
                             std::optional<std::size_t> indices) {
  Json primitive = {{"attributes", attributes}};
  if (indices) primitive["indices"] = *indices;
  json["meshes"][0]["primitives"].push_back(primitive);
  return json["meshes"][0]["primitives"].back();
}

std::string Builder::glb() const {
  Json document = json;
  document["buffers"][0]["byteLength"] = bin.size();
  return glb_of(document.dump(), bin);
}

std::string Builder::gltf() const {
  Json document = json;
  document["buffers"][0] = {{"byteLength", bin.size()},
                            {"uri", "data:application/octet-stream;base64," + base64(bin)}};
  return document.dump();
}

Builder square() {
  Builder b;
  const std::size_t position = b.add("VEC3", 5126, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5});
  b.json["accessors"][position]["min"] = {0, 0, 0};
  b.json["accessors"][position]["max"] = {1, 1, 0.5};
  b.add_primitive({{"POSITION", position}}, b.add("SCALAR", 5123, {0, 1, 2, 0, 2, 3}));
  return b;
}

Builder grid(int n) {
  Builder b;
  std::vector<double> points;
  std::vector<double> corners;
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k <= n; ++k) points.insert(points.end(), {0.5 * i, 0.25 * k, 0.125 * i * k});
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      const int a = i * (n + 1) + k;
      for (const int corner : {a, a + 1, a + n + 2, a, a + n + 2, a + n + 1})
        corners.push_back(corner);
    }
  const std::size_t position = b.add("VEC3", 5126, points);
  b.json["accessors"][position]["min"] = {0, 0, 0};
  b.json["accessors"][position]["max"] = {0.5 * n, 0.25 * n, 0.125 * n * n};
  b.add_primitive({{"POSITION", position}}, b.add("SCALAR", 5125, corners));
  return b;
}

std::string glb_of(const std::string& json, const std::string& bin) {
  std::string text = json;
  std::string bytes = bin;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  bytes.resize((bytes.size() + 3) / 4 * 4);
  std::string file = "glTF";
  for (const std::size_t word : {std::size_t{2}, 28 + text.size() + bytes.size(), text.size()})
    put<std::uint32_t>(file, static_cast<double>(word));
  file += "JSON" + text;
  put<std::uint32_t>(file, static_cast<double>(bytes.size()));
  return file + std::string("BIN\0", 4) + bytes;
}

Json json_of(const std::string& file) {
  if (file.substr(0, 4) != "glTF") return Json::parse(file);
  std::uint32_t length = 0;
  std::memcpy(&length, file.data() + 12, 4);
  return Json::parse(file.substr(20, length));
}

Asset read_file(const std::string& document, const AssetOptions& options) {
  return read({document, {}}, {}, options);
}

Error error_of(const std::string& document, const ReadLimits& limits) {
  try {
    read({document, {}}, limits);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "reading succeeded";
  return Error(ErrorCode::internal, "none");
}

void try_file(const std::string& document) {
  try {
    const Asset asset = read({document, {}}, {.max_vertices = 100'000, .max_faces = 100'000});
    const std::vector<UnwrappedSurface> unwrapped = split_everywhere(asset);
    for (const Format format : {Format::glb, Format::gltf, Format::obj})
      EXPECT_FALSE(write(asset, unwrapped, format).empty());
  } catch (const Error& error) {
    EXPECT_NE(error.code(), ErrorCode::internal);
  }
}

std::array<double, 2> uv_of(const std::array<Vec3, 3>& face, int corner) {
  const std::uint64_t all = hash_of(face[0]) + hash_of(face[1]) + hash_of(face[2]);
  const std::uint64_t hash = mixed(all ^ mixed(hash_of(face[static_cast<std::size_t>(corner)])));
  return {static_cast<double>(hash >> 48) / 65536,
          static_cast<double>(hash >> 32 & 0xffff) / 65536};
}

std::vector<UnwrappedSurface> split_everywhere(const Asset& asset) {
  std::vector<UnwrappedSurface> unwrapped = split_nowhere(asset);
  for (std::size_t s = 0; s < unwrapped.size(); ++s) {
    const Surface& surface = asset.surfaces()[s];
    UnwrappedSurface& result = unwrapped[s];
    std::vector<char> used(surface.mesh.positions.size(), 0);
    for (std::size_t t = 0; t < surface.mesh.faces.size(); ++t) {
      std::array<Vec3, 3> points;
      for (std::size_t k = 0; k < 3; ++k)
        points[k] = surface.mesh.positions[static_cast<std::size_t>(surface.mesh.faces[t][k])];
      for (std::size_t k = 0; k < 3; ++k) {
        const Index vertex = surface.mesh.faces[t][k];
        const auto [u, v] = uv_of(points, static_cast<int>(k));
        if (used[static_cast<std::size_t>(vertex)]++ == 0) {
          result.uv[static_cast<std::size_t>(vertex)] = {u, v};
          continue;
        }
        used[static_cast<std::size_t>(vertex)] = 1;
        result.faces[t][k] = static_cast<Index>(result.source.size());
        result.source.push_back(vertex);
        result.uv.emplace_back(u, v);
      }
    }
  }
  return unwrapped;
}

std::vector<UnwrappedSurface> split_nowhere(const Asset& asset) {
  std::vector<UnwrappedSurface> unwrapped;
  for (const Surface& surface : asset.surfaces()) {
    UnwrappedSurface result;
    result.faces = surface.mesh.faces;
    for (Index i = 0; i < surface.mesh.vertex_count(); ++i) {
      result.source.push_back(i);
      result.uv.emplace_back(i % 97 / 97.0, i % 89 / 89.0);
    }
    unwrapped.push_back(std::move(result));
  }
  return unwrapped;
}

std::optional<std::filesystem::path> test_data() {
  const std::filesystem::path folder = unwrapd::test_data();
  if (folder.empty()) return std::nullopt;
  return folder;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder,
                                               const std::vector<std::string>& endings) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    for (const std::string& ending : endings)
      if (entry.is_regular_file() && entry.path().string().ends_with(ending))
        files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::map<std::string, std::string> buffers_beside(const std::filesystem::path& file) {
  std::map<std::string, std::string> buffers;
  const Json document = Json::parse(bytes_of(file), nullptr, false);
  if (!document.is_object() || !document.contains("buffers") || !document["buffers"].is_array())
    return buffers;
  for (const Json& buffer : document["buffers"]) {
    if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string()) continue;
    const std::string uri = buffer["uri"];
    if (uri.starts_with("data:") || uri.find("..") != std::string::npos) continue;
    const std::filesystem::path beside = file.parent_path() / uri;
    if (std::filesystem::is_regular_file(beside)) buffers[uri] = bytes_of(beside);
  }
  return buffers;
}

Input input_of(const std::string& document, const std::map<std::string, std::string>& buffers) {
  Input input{document, {}};
  for (const auto& [uri, bytes] : buffers) input.buffers[uri] = bytes;
  return input;
}

}  // namespace unwrapd::asset::test
