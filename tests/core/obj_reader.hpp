#pragma once
// A reader for the tests' own use: `v` and `f` of an OBJ file, polygons cut into fans. Product code
// reads OBJ with core/asset; this one depends on nothing, so that core's tests need core alone.

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/mesh/tri_mesh.hpp"
#include "tests/samples/test_data.hpp"

namespace unwrapd {

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
