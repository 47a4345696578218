// What other readers make of an answer: polygons cut along other diagonals, faces without area.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"
#include "tests/pipeline/written.hpp"

namespace unwrapd {
namespace {

struct WrittenObj {
  std::string text;
  std::vector<Note> notes;
};

WrittenObj unwrapped(const std::string& obj, const UnwrapOptions& options = {}) {
  const asset::Asset asset = asset::read({.document = obj, .buffers = {}}, {});
  SerialExecutor serial;
  const Unwrapped u = unwrap(asset.surfaces(), options, {}, serial);
  return {asset::write(asset, u.surfaces, asset::Format::obj),
          asset::side_effects(asset, u.surfaces, asset::Format::obj)};
}

std::size_t faces_of(const std::string& text) {
  std::istringstream file(text);
  std::size_t count = 0;
  for (std::string line; std::getline(file, line);) count += line.starts_with("f ") ? 1 : 0;
  return count;
}

/// A bumpy sheet of quads, all corners shaken: some quads are not convex.
std::string shaken_quads(int n, unsigned seed) {
  std::mt19937 rng(seed);
  const auto shake = [&] { return 1.1 * (double(rng() % 1000) / 1000 - 0.5); };
  std::ostringstream text;
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k <= n; ++k)
      text << "v " << i + shake() << ' ' << k + shake() << ' ' << 0.3 * shake() << '\n';
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      const int a = i * (n + 1) + k + 1;
      text << "f " << a << ' ' << a + n + 1 << ' ' << a + n + 2 << ' ' << a + 1 << '\n';
    }
  return text.str();
}

void expect_no_flips_by_any_fan(const std::string& obj) {
  for (std::size_t from = 0; from < 4; ++from)
    EXPECT_EQ(flips(triangles_of_obj(obj, from)), 0U) << "fans from corner " << from;
}

TEST(Written, QuadsHaveNoFlipsWhicheverDiagonalAReaderTakes) {
  std::size_t kept = 0, split = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    const WrittenObj answer = unwrapped(shaken_quads(9, seed));
    expect_no_flips_by_any_fan(answer.text);
    const std::size_t triangles = triangles_of_obj(answer.text).size();
    ASSERT_EQ(triangles, 162U);
    const std::size_t own_split = faces_of(answer.text) - 81;
    EXPECT_EQ(answer.notes.size(), own_split > 0 ? 1U : 0U);
    if (own_split > 0) {
      EXPECT_TRUE(answer.notes[0].text.starts_with(std::to_string(own_split) + " of 81 polygons "));
    }
    split += own_split;
    kept += 81 - own_split;
  }
  EXPECT_GT(kept, 200U);
  EXPECT_GT(split, 20U);
}

TEST(Written, FacesWithoutAreaCoverNothingOfThePage) {
  TriMesh mesh = shapes::torus(8, 4);  // the x axis meets it in four vertices
  std::vector<Index> on_axis;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (std::abs(mesh.positions[std::size_t(v)].y()) +
            std::abs(mesh.positions[std::size_t(v)].z()) <
        1e-12) {
      mesh.positions[std::size_t(v)].y() = mesh.positions[std::size_t(v)].z() = 0;
      on_axis.push_back(v);
    }
  ASSERT_EQ(on_axis.size(), 4U);
  mesh.faces.push_back({on_axis[0], on_axis[1], on_axis[2]});
  mesh.faces.push_back({on_axis[3], on_axis[1], on_axis[0]});
  const std::vector<UvTriangle> triangles = triangles_of_obj(unwrapped(obj_text(mesh)).text);
  ASSERT_EQ(triangles.size(), mesh.faces.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    EXPECT_EQ(turn(triangles[t]), t + 2 < triangles.size() ? 1 : 0) << t;
}

}  // namespace
}  // namespace unwrapd
