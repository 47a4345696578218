#pragma once
// A reader for the tests' own use: `v` and `f` of an OBJ file, polygons cut into fans. Product code
// reads OBJ with core/asset; this one depends on nothing, so that core's tests need core alone.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// The folder of real meshes (UNWRAPD_TEST_DATA or beside the checkout); empty when absent.
inline std::filesystem::path test_data() {
  const char* given = std::getenv("UNWRAPD_TEST_DATA");
  const std::filesystem::path path =
      given != nullptr ? std::filesystem::path(given)
                       : std::filesystem::path(__FILE__).parent_path() / "../../../shared/data";
  return std::filesystem::is_directory(path) ? std::filesystem::canonical(path)
                                             : std::filesystem::path();
}

namespace obj_detail {

/// The corners of one `f` line as vertex numbers; negative ones count from the end.
inline std::vector<Index> polygon(std::istringstream& line, Index vertex_count) {
  std::vector<Index> corners;
  for (std::string word; line >> word;) {
    const Index v = static_cast<Index>(std::strtol(word.c_str(), nullptr, 10));
    corners.push_back(v < 0 ? vertex_count + v : v - 1);
  }
  return corners;
}

inline Vec3 point(std::istringstream& line) {
  std::array<std::string, 3> word;
  line >> word[0] >> word[1] >> word[2];
  return {std::strtod(word[0].c_str(), nullptr), std::strtod(word[1].c_str(), nullptr),
          std::strtod(word[2].c_str(), nullptr)};
}

}  // namespace obj_detail

inline TriMesh read_obj(const std::filesystem::path& path) {
  TriMesh mesh;
  std::ifstream file(path);
  for (std::string text; std::getline(file, text);) {
    std::istringstream line(text);
    std::string key;
    line >> key;
    if (key == "v") mesh.positions.push_back(obj_detail::point(line));
    if (key != "f") continue;
    const std::vector<Index> corners = obj_detail::polygon(line, mesh.vertex_count());
    for (std::size_t k = 2; k < corners.size(); ++k)
      mesh.faces.push_back({corners[0], corners[k - 1], corners[k]});
  }
  return mesh;
}

}  // namespace unwrapd
