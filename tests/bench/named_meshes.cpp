#include "tests/bench/named_meshes.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/asset/asset.hpp"
#include "tests/bench/made_shapes.hpp"
#include "tests/bench/noisy_body.hpp"

namespace unwrapd::bench {
namespace {

namespace fs = std::filesystem;

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

constexpr std::string_view kNoisy = "noisy:";
constexpr double kNoise = 0.25;  // of the mean edge, up and down

double noisy_faces(const std::string& name) {
  return std::strtod(name.c_str() + kNoisy.size(), nullptr);
}

bool is_noisy(const std::string& name) {
  return name.starts_with(kNoisy) && noisy_faces(name) >= 1000;
}

constexpr std::string_view kMade = "made:";

bool is_made(const std::string& name) {
  return name.starts_with(kMade) && !made_shape(name.substr(kMade.size())).faces.empty();
}

std::vector<Surface> generated(const std::string& name) {
  Surface surface{.mesh = is_noisy(name) ? noisy_body(noisy_faces(name), kNoise)
                                         : made_shape(name.substr(kMade.size())),
                  .part = {},
                  .name = "generated"};
  surface.part.assign(surface.mesh.faces.size(), 0);
  return {std::move(surface)};
}

}  // namespace

bool is_generated(const std::string& name) { return is_noisy(name) || is_made(name); }

std::vector<Surface> read_surfaces(const fs::path& path) {
  if (is_generated(path.string())) return generated(path.string());
  asset::Input input;
  const std::string document = read_file(path);
  input.document = document;
  std::vector<std::string> buffers;
  if (path.extension() == ".gltf")
    for (const auto& entry : fs::directory_iterator(path.parent_path()))
      if (entry.is_regular_file() && entry.path() != path) {
        buffers.push_back(entry.path().filename().string());
        buffers.push_back(read_file(entry.path()));
      }
  for (std::size_t k = 0; k + 1 < buffers.size(); k += 2)
    input.buffers[buffers[k]] = buffers[k + 1];
  const asset::Asset asset = asset::read(input, {});
  return {asset.surfaces().begin(), asset.surfaces().end()};
}

std::vector<fs::path> meshes_in(const fs::path& path) {
  if (is_generated(path.string()) || !fs::is_directory(path)) return {path};
  std::vector<fs::path> found;
  for (const auto& entry : fs::recursive_directory_iterator(path)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".obj" || ending == ".glb" || ending == ".gltf") found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace unwrapd::bench
