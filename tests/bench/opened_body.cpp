#include "tests/bench/opened_body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <random>
#include <utility>
#include <vector>

#include "core/mesh/halfedges.hpp"
#include "core/mesh/topology.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::bench {
namespace {

struct Limb {
  Vec3 towards;
  double length, width;
};

double drawn(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

Vec3 direction(std::mt19937& random) {
  const double z = drawn(random, -1, 1), turn = drawn(random, 0, shapes::kTurn);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

std::vector<Limb> limbs(std::mt19937& random) {
  std::vector<Limb> all;
  for (std::size_t k = 4 + random() % 5; k > 0; --k)
    all.push_back({direction(random), drawn(random, .4, 2), drawn(random, .2, .5)});
  return all;
}

double radius(const Vec3& towards, const std::vector<Limb>& limbs) {
  double radius = 1;
  for (const Limb& limb : limbs) {
    const double away = (towards - limb.towards).norm() / limb.width;
    radius += limb.length * std::exp(-away * away);
  }
  return radius;
}

/// An even grid on the six sides of a cube, pulled onto the ball.
TriMesh ball(double faces) {
  const auto side = std::max<Index>(2, static_cast<Index>(std::lround(std::sqrt(faces / 12))));
  std::vector<TriMesh> sides;
  for (int k = 0; k < 6; ++k)
    sides.push_back(shapes::mapped_grid(side, side, shapes::Wrap::none, [&](double u, double v) {
      const double a = std::tan((u - .5) * shapes::kTurn / 4);
      const double b = std::tan((v - .5) * shapes::kTurn / 4);
      const double sign = k % 2 == 0 ? 1 : -1;
      Vec3 p;
      p[k / 2] = sign, p[(k / 2 + 1) % 3] = sign * a, p[(k / 2 + 2) % 3] = b;
      return p.normalized();
    }));
  return shapes::merged(sides);
}

/// One vertex for all that lie at a place, to a millionth.
TriMesh joined(const TriMesh& mesh) {
  std::map<std::array<long, 3>, Index> known;
  TriMesh one;
  std::vector<Index> number;
  for (const Vec3& p : mesh.positions) {
    const std::array<long, 3> key{std::lround(1e6 * p.x()), std::lround(1e6 * p.y()),
                                  std::lround(1e6 * p.z())};
    const auto [at, is_new] = known.try_emplace(key, one.vertex_count());
    if (is_new) one.positions.push_back(p);
    number.push_back(at->second);
  }
  for (const Triangle& face : mesh.faces)
    one.faces.push_back({number[face[0]], number[face[1]], number[face[2]]});
  return one;
}

/// The half-edge by which each vertex is left on the shortest way to the tree; kNoTwin in it.
std::vector<Index> ways_to(const TriMesh& mesh, const std::vector<std::vector<Index>>& leaving,
                           const std::vector<char>& in_tree) {
  std::vector<double> length(in_tree.size(), std::numeric_limits<double>::infinity());
  std::vector<Index> by(in_tree.size(), kNoTwin);
  std::priority_queue<std::pair<double, Index>, std::vector<std::pair<double, Index>>,
                      std::greater<>>
      queue;
  for (Index v = 0; v < static_cast<Index>(in_tree.size()); ++v)
    if (in_tree[v] != 0) queue.push({length[v] = 0, v});
  while (!queue.empty()) {
    const auto [so_far, v] = queue.top();
    queue.pop();
    if (so_far > length[v]) continue;
    for (const Index h : leaving[v]) {
      const Index to = mesh.faces[h / 3][(h + 1) % 3];
      const double own = so_far + (mesh.positions[to] - mesh.positions[v]).norm();
      if (own < length[to]) length[to] = own, by[to] = h, queue.push({own, to});
    }
  }
  return by;
}

/// The mesh cut open along the tree that grows from tip to tip.
TriMesh cut_between(const TriMesh& mesh, const std::vector<Index>& tips) {
  Halfedges halfedges = build_halfedges(mesh.faces, mesh.vertex_count());
  std::vector<std::vector<Index>> leaving(mesh.positions.size());
  for (Index h = 0; h < 3 * mesh.face_count(); ++h) leaving[mesh.faces[h / 3][h % 3]].push_back(h);
  std::vector<char> in_tree(mesh.positions.size(), 0);
  in_tree[tips.front()] = 1;
  const std::vector<Index> twin = halfedges.twin;
  for (const Index tip : tips) {
    const std::vector<Index> by = ways_to(mesh, leaving, in_tree);
    for (Index v = tip; in_tree[v] == 0; v = mesh.faces[by[v] / 3][by[v] % 3]) {
      in_tree[v] = 1;
      halfedges.twin[by[v]] = halfedges.twin[twin[by[v]]] = kNoTwin;
    }
  }
  CornerVertices corners = corner_vertices(halfedges);
  TriMesh open{std::vector<Vec3>(corners.count), corners.faces};
  for (std::size_t t = 0; t < mesh.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      open.positions[open.faces[t][i]] = mesh.positions[mesh.faces[t][i]];
  return open;
}

}  // namespace

TriMesh opened_body(double faces, unsigned seed) {
  std::mt19937 random(seed + 1);
  const std::vector<Limb> all = limbs(random);
  TriMesh mesh = joined(ball(faces));
  std::vector<Index> tips;
  for (const Limb& limb : all) {
    const auto to_tip = [&](const Vec3& p) { return (p - limb.towards).norm(); };
    const auto tip = std::ranges::min_element(mesh.positions, {}, to_tip);
    tips.push_back(static_cast<Index>(tip - mesh.positions.begin()));
  }
  for (Vec3& p : mesh.positions) p *= radius(p, all);
  return cut_between(mesh, tips);
}

}  // namespace unwrapd::bench
