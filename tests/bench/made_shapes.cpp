#include "tests/bench/made_shapes.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <sstream>

#include "tests/bench/noisy_body.hpp"
#include "tests/bench/opened_body.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::bench {
namespace {

using Random = std::mt19937;

double between(Random& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

/// Refined until another time would pass the number of faces by much.
TriMesh refined(TriMesh mesh, double faces) {
  while (static_cast<double>(mesh.faces.size()) * 2.5 < faces) mesh = shapes::subdivided(mesh);
  return mesh;
}

TriMesh blocks(double faces, Random& random) {
  std::set<std::array<int, 3>> cells{{0, 0, 0}};
  std::array<int, 3> at{0, 0, 0};
  for (int k = 0; k < 12; ++k) {
    at[random() % 3] += random() % 2 == 0 ? 1 : -1;
    cells.insert(at);
  }
  return refined(shapes::voxel_surface(cells), faces);
}

TriMesh boxes(double faces, Random& random) {
  const int count = std::max(1, static_cast<int>(faces / 12));
  std::vector<TriMesh> all;
  for (int k = 0; k < count; ++k) {
    TriMesh box = shapes::cube();
    const Vec3 size(between(random, .2, 1), between(random, .2, 1), between(random, .2, 1));
    for (Vec3& p : box.positions) p = p.cwiseProduct(size) + Vec3(2 * k, 0, 0);
    all.push_back(std::move(box));
  }
  return shapes::merged(all);
}

TriMesh triangles_apart(double faces, Random& random) {
  TriMesh mesh;
  for (Index k = 0; k < static_cast<Index>(faces); ++k) {
    for (int i = 0; i < 3; ++i)
      mesh.positions.emplace_back(between(random, 0, 1) + 2 * k, between(random, 0, 1),
                                  between(random, 0, 1));
    mesh.faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  return mesh;
}

Index side(double faces) { return std::max<Index>(3, static_cast<Index>(std::sqrt(faces / 2))); }

TriMesh torus(double faces, Random& random) {
  const double ratio = between(random, 1.5, 3);
  const auto along = static_cast<Index>(std::sqrt(faces / 2 / ratio));
  return shapes::torus(static_cast<Index>(ratio * along), std::max<Index>(along, 3), 1,
                       between(random, .2, .6));
}

TriMesh cap(double faces, Random& random) {
  return shapes::sphere_cap(2 * side(faces) / 2, side(faces), between(random, 1.2, 2.6));
}

TriMesh of_size(TriMesh mesh, double size, double at) {
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3& p : mesh.positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const double factor = size / (high - low).maxCoeff();
  for (Vec3& p : mesh.positions) p = factor * (p - low) + Vec3(at, 0, 0);
  return mesh;
}

TriMesh crowd(double faces, Random& random) {
  const int bodies = 1 + static_cast<int>(random() % 3),
            parts = 10 + static_cast<int>(random() % 50);
  const double size = between(random, .04, .2);
  std::vector<TriMesh> all;
  for (int k = 0; k < bodies; ++k)
    all.push_back(
        of_size(seeded_body(faces / (2 * bodies), 0, static_cast<unsigned>(random())), 1, 2 * k));
  for (int k = 0; k < parts; ++k) {
    const double own = std::max(16.0, faces / (2 * parts));
    const std::array<TriMesh, 3> kinds{blocks(own, random), torus(own, random), cap(own, random)};
    all.push_back(of_size(kinds[random() % 3], size * between(random, .4, 1.2), 2 * (bodies + k)));
  }
  return shapes::merged(all);
}

/// Tiles of a floor, walls on their borders and crates on each other in their middles. Each has
/// vertices of its own.
TriMesh kit(double faces, Random& random) {
  const TriMesh tile = shapes::grid(4, 4, 4, 4), crate = shapes::cube();
  const auto tiles = std::max(2, static_cast<int>(std::lround(std::sqrt(faces / 76))));
  std::vector<TriMesh> all;
  for (int k = 0; k < tiles * tiles; ++k) {
    const Vec3 at(4 * (k % tiles), 4 * (k / tiles), 0);
    all.push_back(shapes::moved(tile, at));
    for (const bool is_along_x : {true, false}) {
      if (between(random, 0, 1) > .4) continue;
      TriMesh wall = tile;
      for (Vec3& p : wall.positions)
        p = is_along_x ? Vec3(p.x(), 0, .75 * p.y()) : Vec3(0, p.x(), .75 * p.y());
      all.push_back(shapes::moved(wall, at));
    }
    const auto crates = static_cast<int>(random() % 4);
    for (int c = 0; c < crates; ++c) all.push_back(shapes::moved(crate, at + Vec3(1, 1, c)));
  }
  return shapes::merged(all);
}

/// A plate with wells, cones and domes on it, much smaller than the plate, as machine parts have.
TriMesh plate(double faces, Random& random) {
  struct Feature {
    unsigned kind;
    double radius, height;
  };
  const int cells = 4 + static_cast<int>(random() % 6);
  std::vector<Feature> features(static_cast<std::size_t>(cells * cells));
  for (Feature& own : features)
    own = {static_cast<unsigned>(random() % 4), between(random, .08, .3), between(random, .5, 2.5)};
  return shapes::mapped_grid(side(faces), side(faces), shapes::Wrap::none, [&](double u, double v) {
    const auto cell = [&](double x) { return std::min(cells - 1, static_cast<int>(x * cells)); };
    const auto off = [&](double x) { return x * cells - cell(x) - 0.5; };
    const Feature& own = features[static_cast<std::size_t>(cells * cell(v) + cell(u))];
    const double away = std::hypot(off(u), off(v)) / own.radius, size = own.radius * own.height;
    if (own.kind == 3 || away > 1) return Vec3(cells * u, cells * v, 0);
    const double height = own.kind == 0   ? -1
                          : own.kind == 1 ? 1 - away
                                          : std::sqrt(1 - away * away);
    return Vec3(cells * u, cells * v, size * height);
  });
}

}  // namespace

TriMesh made_shape(const std::string& name) {
  std::string family;
  double faces = 0;
  unsigned seed = 0;
  char colon = ':';
  std::istringstream words(name);
  if (!std::getline(words, family, ':') || !(words >> faces >> colon >> seed)) return {};
  Random random(seed + 1);
  if (family == "body") return seeded_body(faces, 0, seed);
  if (family == "noisy") return seeded_body(faces, 0.25, seed);
  if (family == "blocks") return blocks(faces, random);
  if (family == "boxes") return boxes(faces, random);
  if (family == "soup") return triangles_apart(faces, random);
  if (family == "hill") return shapes::random_disk(side(faces), seed);
  if (family == "cap") return cap(faces, random);
  if (family == "torus") return torus(faces, random);
  if (family == "crowd") return crowd(faces, random);
  if (family == "kit") return kit(faces, random);
  if (family == "plate") return plate(faces, random);
  if (family == "opened") return opened_body(faces, seed);
  return {};
}

}  // namespace unwrapd::bench
