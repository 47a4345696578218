#pragma once
// The unit cube in the formats of bare geometry, made here.

#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <string>

#include "core/asset/asset.hpp"

namespace unwrapd::asset::test {

inline const std::array<std::array<int, 3>, 8> kCubeCorners = {
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

/// Outwards.
inline const std::array<std::array<int, 4>, 6> kCubeQuads = {
    {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

/// A number's bytes, the lowest first, or the highest.
template <class T>
std::string bytes(T value, bool big_endian = false) {
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  return big_endian ? std::string(raw.rbegin(), raw.rend()) : std::string(raw.begin(), raw.end());
}

/// Calls visit with the corners of each of the cube's 12 triangles.
template <class Visit>
void for_each_cube_triangle(const Visit& visit) {
  for (const auto& [a, b, c, d] : kCubeQuads) {
    visit(std::array{a, b, c});
    visit(std::array{a, c, d});
  }
}

inline std::string cube_stl(std::string head = "made here") {
  head.resize(80);
  std::string file = head + bytes(std::uint32_t{12});
  for_each_cube_triangle([&](const std::array<int, 3>& corners) {
    file += std::string(12, '\0');
    for (const int corner : corners)
      for (const int x : kCubeCorners[static_cast<std::size_t>(corner)])
        file += bytes(static_cast<float>(x));
    file += std::string(2, '\0');
  });
  return file;
}

inline std::string cube_text_stl() {
  std::string file = "solid a cube\n";
  for_each_cube_triangle([&](const std::array<int, 3>& corners) {
    file += "  facet normal 0 0 1\n    outer loop\n";
    for (const int corner : corners) {
      const auto& [x, y, z] = kCubeCorners[static_cast<std::size_t>(corner)];
      file += "      vertex " + std::to_string(x) + " " + std::to_string(y) + " " +
              std::to_string(z) + "e0\n";
    }
    file += "    endloop\n  endfacet\n";
  });
  return file + "endsolid a cube\n";
}

inline std::string cube_off() {
  std::string file = "OFF # a cube\n8 6 12\n\n";
  for (const auto& [x, y, z] : kCubeCorners)
    file += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  for (const auto& [a, b, c, d] : kCubeQuads)
    file += "4 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + " " +
            std::to_string(d) + " 255 0 0\n";
  return file;
}

/// With normals, texture coordinates and colours of the vertices, and an element after the faces.
inline std::string ply_head(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment a cube\nelement vertex 8\nproperty float x\n"
         "property double y\nproperty short z\nproperty float nx\nproperty float ny\n"
         "property float nz\nproperty uchar red\nproperty float s\nproperty float t\n"
         "element face 6\nproperty list uchar int vertex_indices\nproperty list ushort float w\n"
         "element edge 1\nproperty int vertex1\nend_header\n";
}

inline std::string cube_binary_ply(bool big_endian) {
  std::string file = ply_head(big_endian ? "binary_big_endian" : "binary_little_endian");
  const auto add = [&](auto value) { file += bytes(value, big_endian); };
  for (const auto& [x, y, z] : kCubeCorners) {
    add(static_cast<float>(x));
    add(static_cast<double>(y));
    add(static_cast<std::int16_t>(z));
    for (const float n : {0.F, 0.F, 1.F}) add(n);
    add(std::uint8_t{200});
    add(static_cast<float>(x) / 2);
    add(static_cast<float>(y) / 4);
  }
  for (const auto& quad : kCubeQuads) {
    add(std::uint8_t{4});
    for (const int corner : quad) add(std::int32_t{corner});
    add(std::uint16_t{1});
    add(0.5F);
  }
  add(std::int32_t{0});
  return file;
}

inline std::string cube_text_ply() {
  std::string file = ply_head("ascii");
  for (const auto& [x, y, z] : kCubeCorners)
    file += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + " 0 0 1 200 " +
            std::to_string(x / 2.) + " " + std::to_string(y / 4.) + "\n";
  for (const auto& [a, b, c, d] : kCubeQuads)
    file += "4 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + " " +
            std::to_string(d) + " 1 0.5\n";
  return file + "0\n";
}

/// Its sides as strips with -1 between them. `corners`: of all strips, in one list.
inline std::string strips_ply(const std::vector<int>& corners, bool is_text) {
  std::string file = std::string("ply\nformat ") + (is_text ? "ascii" : "binary_little_endian") +
                     " 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
                     "property float z\nelement tristrips 1\n"
                     "property list int int vertex_indices\nend_header\n";
  const auto add = [&](auto value) {
    file += is_text ? std::to_string(value) + " " : bytes(value, false);
  };
  for (const auto& [x, y, z] : kCubeCorners)
    for (const int value : {x, y, z}) add(static_cast<float>(value));
  add(static_cast<std::int32_t>(corners.size()));
  for (const int corner : corners) add(std::int32_t{corner});
  return file;
}

/// The cube in every encoding, by its name.
inline const std::map<std::string, std::string>& cubes() {
  static const std::map<std::string, std::string> kCubes = {
      {"binary STL", cube_stl()},
      {"binary STL that starts as text does", cube_stl("solid of an exporter")},
      {"STL as text", cube_text_stl()},
      {"OFF", cube_off()},
      {"PLY as text", cube_text_ply()},
      {"little-endian PLY", cube_binary_ply(false)},
      {"big-endian PLY", cube_binary_ply(true)}};
  return kCubes;
}

/// A text with one other part.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return text.replace(at, from.size(), to);
}

}  // namespace unwrapd::asset::test
