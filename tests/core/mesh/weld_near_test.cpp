#include "core/mesh/weld_near.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "core/mesh/weld.hpp"
#include "tests/core/rounded.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using shapes::Rounded;

/// The welding of a mesh: exact first, then near.
std::vector<Index> welding_of(const TriMesh& mesh, std::optional<double> distance = {}) {
  std::vector<Index> first_at = weld(mesh.positions);
  const std::vector<Triangle> faces = renumber(mesh.faces, first_at);
  const FaceStates states = inspect_areas(mesh, faces);
  std::vector<EdgeSide> sides =
      edge_sides(faces, [&](Index h) { return states.of[face_of(h)] == FaceState::sound; });
  sort_by_edge(sides, mesh.vertex_count());
  const std::vector<Index> near = weld_near({mesh, faces, states, sides}, distance);
  if (!near.empty())
    for (Index& v : first_at) v = near[v];
  return first_at;
}

/// How many pairs of vertices with one exact vertex are apart (neighbours in the order of vertices
/// only), and how many that are welded have different ones.
struct Faults {
  int apart = 0, merged = 0;
};

Faults faults_of(const Rounded& soup, const std::vector<Index>& welded) {
  Faults faults;
  std::map<Index, Index> of_exact, of_welded;
  for (std::size_t v = 0; v < welded.size(); ++v) {
    faults.apart += of_exact.try_emplace(soup.exact[v], welded[v]).first->second != welded[v];
    faults.merged += of_welded.try_emplace(welded[v], soup.exact[v]).first->second != soup.exact[v];
  }
  return faults;
}

void expect_welded(const Rounded& soup, const std::string& name) {
  const Faults faults = faults_of(soup, welding_of(soup.mesh));
  EXPECT_EQ(faults.apart, 0) << name << " of " << soup.exact.size();
  EXPECT_EQ(faults.merged, 0) << name;
}

std::vector<std::pair<std::string, TriMesh>> families() {
  return {{"sphere", shapes::sphere(3)},
          {"cube", shapes::cube(2)},
          {"two cubes",
           shapes::together(shapes::cube(), shapes::moved(shapes::cube(1), 1e-2, {3, 0, 0}))},
          {"torus", shapes::torus(24, 12)},
          {"grid", shapes::grid(9, 7)},
          {"cap", shapes::sphere_cap(200, 12)},
          {"bar", shapes::pierced_bar(3)},
          {"tetrahedron", TriMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                  {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}}}};
}

TEST(WeldNear, GivesARoundedSoupItsSurfaceBack) {
  for (const auto& [name, mesh] : families())
    for (const double noise : {1e-12, 1e-8, 1e-7, 1e-6})
      for (const unsigned seed : {1U, 2U, 3U}) {
        Rounded soup = shapes::rounded_soup(mesh, noise, seed);
        shapes::wind_at_random(0.5, seed, soup);
        expect_welded(soup, name + " " + std::to_string(noise * 1e9) + "e-9");
      }
}

TEST(WeldNear, GivesASoupOfFewDecimalsItsSurfaceBack) {
  for (const auto& [name, mesh] : families())
    for (const int decimals : {6, 7, 8})
      for (const unsigned seed : {1U, 2U, 3U})
        expect_welded(shapes::decimal_soup(mesh, decimals, seed),
                      name + " " + std::to_string(decimals));
}

TEST(WeldNear, DependsOnNeitherScaleNorPlace) {
  const TriMesh mesh = shapes::torus(24, 12);
  for (const double scale : {1e-100, 1e-9, 1e9, 1e100}) {
    Rounded soup = shapes::rounded_soup(mesh, 1e-7, 4);
    soup.mesh = shapes::moved(soup.mesh, scale, scale * Vec3(1e3, -1e4, 0));
    expect_welded(soup, std::to_string(std::log10(scale)));
  }
}

TEST(WeldNear, KeepsRealGapsOpen) {
  for (const double width : {1e-7, 1e-6, 3e-6, 1e-5, 1e-3}) {
    for (const Index n : {5, 10, 40}) {
      expect_welded(shapes::apart(shapes::slit_square(n, width)), "slit");
      expect_welded(shapes::apart(shapes::thin_wall(n, width)), "wall");
    }
    for (const double size : {1e1, 1e3, 1e5})
      expect_welded(shapes::apart(shapes::tiles(6, width, size)), "tiles");
  }
}

TEST(WeldNear, KeepsRealGapsOpenAmongRounding) {
  for (const unsigned seed : {1U, 2U, 3U})
    for (const double width : {3e-6, 1e-5, 1e-3}) {
      expect_welded(shapes::rounded_soup(shapes::slit_square(12, width), 1e-8, seed), "slit");
      expect_welded(shapes::rounded_soup(shapes::thin_wall(12, width), 1e-8, seed), "wall");
      expect_welded(shapes::rounded_soup(shapes::tiles(6, 0.01, 100), 1e-8, seed), "tiles");
    }
}

TEST(WeldNear, WeldsTwoHalvesThatWereRoundedApart) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    Rounded halves = shapes::apart(shapes::grid(20, 20));
    // The faces of each half keep common vertices.
    const std::vector<Index> first_at = weld(halves.mesh.positions);
    std::vector<Vec3> upper = halves.mesh.positions;
    TriMesh noisy = halves.mesh;
    shapes::add_noise(1e-6, seed, noisy);
    for (std::size_t t = 400; t < 800; ++t)
      for (const Index v : halves.mesh.faces[t])
        upper[std::size_t(v)] = noisy.positions[std::size_t(first_at[std::size_t(v)])];
    halves.mesh.positions = upper;
    expect_welded(halves, "halves");
  }
}

TEST(WeldNear, LeavesMeshesAloneThatNeedIt) {
  for (const auto& [name, mesh] : families()) {
    EXPECT_EQ(welding_of(mesh), weld(mesh.positions)) << name;
    const Rounded soup = shapes::apart(mesh);
    EXPECT_EQ(welding_of(soup.mesh), weld(soup.mesh.positions)) << name;
  }
}

TEST(WeldNear, WeldsWithinADistanceThatIsGiven) {
  Rounded soup = shapes::rounded_soup(shapes::grid(8, 8), 1e-3, 7);
  const Faults own = faults_of(soup, welding_of(soup.mesh));
  EXPECT_GT(own.apart, 0);  // more than rounding
  const Faults given = faults_of(soup, welding_of(soup.mesh, 0.01));
  EXPECT_EQ(given.apart, 0);
  EXPECT_EQ(given.merged, 0);
  const Rounded slit = shapes::apart(shapes::slit_square(8, 1e-6));
  EXPECT_EQ(faults_of(slit, welding_of(slit.mesh, 1e-5)).merged, 15);  // 3 corners at each of 5
}

void expect_faces_with_corners(const TriMesh& mesh, double distance, const std::string& name) {
  for (const Triangle& face : renumber(mesh.faces, welding_of(mesh, distance)))
    EXPECT_FALSE(repeats_vertex(face)) << name;
}

TEST(WeldNear, NeverCollapsesAFace) {
  for (const auto& [name, mesh] : families()) expect_faces_with_corners(mesh, 1e100, name);
  const TriMesh needles = shapes::mapped_grid(9, 9, shapes::Wrap::none, [](double u, double v) {
    return Vec3(u < 0.5 ? u : u - 1.0 / 9 + 1e-7, v, 0);  // a column narrower than the rounding
  });
  for (const unsigned seed : {1U, 2U, 3U})
    expect_faces_with_corners(shapes::rounded_soup(needles, 1e-6, seed).mesh, 1e-5, "needles");
}

}  // namespace
}  // namespace unwrapd
