#pragma once
// Answers as they are written, read back by readers of the tests' own.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "tests/asset/support.hpp"

namespace unwrapd {

struct UvTriangle {
  std::array<Vec2, 3> corner;  ///< V pointing up
};

/// The sign of the orientation of points that are floats: 80 bits hold every product of differences
/// of numbers that share their last place, and all written ones do (multiples of 2^-24).
inline int turn(const UvTriangle& t) {
  std::array<std::int64_t, 6> at{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const double steps = std::ldexp(t.corner[i][Eigen::Index(k)], 24);
      EXPECT_EQ(steps, std::round(steps));
      at[2 * i + k] = std::int64_t(steps);
    }
  const std::int64_t d = (at[2] - at[0]) * (at[5] - at[1]) - (at[3] - at[1]) * (at[4] - at[0]);
  return d > 0 ? 1 : d < 0 ? -1 : 0;
}

inline std::vector<UvTriangle> triangles_of_glb(const std::string& file) {
  std::vector<UvTriangle> triangles;
  for (const auto& primitive : asset::test::read_naively(file))
    for (const auto& face : primitive.faces) {
      UvTriangle t;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::vector<double>& uv = face.at("TEXCOORD_0")[i];
        t.corner[i] = Vec2(uv[0], 1 - uv[1]);
      }
      triangles.push_back(t);
    }
  return triangles;
}

/// The faces of an OBJ as a reader of doubles sees them, polygons cut into fans from corner `from`.
inline std::vector<UvTriangle> triangles_of_obj(const std::string& text, std::size_t from = 0) {
  std::vector<UvTriangle> triangles;
  UvMap uv;
  std::istringstream file(text);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string key, word;
    double u = 0, v = 0;
    words >> key;
    if (key == "vt" && words >> u >> v) uv.emplace_back(u, v);
    if (key != "f") continue;
    UvMap corners;
    while (words >> word)
      corners.push_back(uv.at(std::size_t(std::stol(word.substr(word.find('/') + 1))) - 1));
    const std::size_t n = corners.size();
    for (std::size_t k = 2; k < n; ++k)
      triangles.push_back(
          {{corners[from % n], corners[(from + k - 1) % n], corners[(from + k) % n]}});
  }
  return triangles;
}

inline std::size_t flips(const std::vector<UvTriangle>& triangles) {
  return std::size_t(std::count_if(triangles.begin(), triangles.end(),
                                   [](const UvTriangle& t) { return turn(t) <= 0; }));
}

inline std::string obj_text(const TriMesh& mesh) {
  std::ostringstream text;
  text.precision(17);
  for (const Vec3& p : mesh.positions) text << "v " << p.transpose() << '\n';
  for (const auto& [a, b, c] : mesh.faces)
    text << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  return text.str();
}

}  // namespace unwrapd
