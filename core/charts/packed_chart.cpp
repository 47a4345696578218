#include "core/charts/packed_chart.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/error.hpp"

namespace unwrapd::charts {
namespace {

void require(bool is_sound) {
  if (!is_sound) throw Error(ErrorCode::internal, "A packed chart is unsound.");
}

bool is_within(Index value, Index least, std::size_t count) {
  return value >= least && value < static_cast<Index>(count);
}

template <class Vector>
bool are_finite(const std::vector<Vector>& all) {
  return std::ranges::all_of(all, [](const Vector& v) { return v.allFinite(); });
}

TriMesh next_mesh(ByteUnpacker& bytes) {
  TriMesh mesh{bytes.next_list<Vec3>(), bytes.next_list<Triangle>()};
  require(!mesh.faces.empty() && are_finite(mesh.positions));
  for (const Triangle& face : mesh.faces)
    for (const Index v : face) require(is_within(v, 0, mesh.positions.size()));
  return mesh;
}

/// Twins are each other's.
Halfedges next_halfedges(ByteUnpacker& bytes, std::size_t faces) {
  Halfedges own{bytes.next_list<Index>()};
  require(own.twin.size() == 3 * faces);
  for (std::size_t h = 0; h < own.twin.size(); ++h) {
    const Index twin = own.twin[h];
    require(is_within(twin, kNoTwin, own.twin.size()));
    require(twin == kNoTwin || own.twin[static_cast<std::size_t>(twin)] == static_cast<Index>(h));
  }
  return own;
}

std::vector<BoundaryLoop> next_loops(ByteUnpacker& bytes, const Halfedges& halfedges) {
  std::vector<BoundaryLoop> loops;
  for (auto left = bytes.next<std::uint32_t>(); left > 0; --left) {
    loops.push_back(bytes.next_list<Index>());
    for (const Index h : loops.back())
      require(is_within(h, 0, halfedges.twin.size()) &&
              halfedges.twin[static_cast<std::size_t>(h)] == kNoTwin);
  }
  return loops;
}

template <class Item>
std::vector<Item> next_of_each(ByteUnpacker& bytes, std::size_t count) {
  std::vector<Item> list = bytes.next_list<Item>();
  require(list.empty() || list.size() == count);
  return list;
}

}  // namespace

void pack(BytePacker& bytes, const Chart& chart) {
  const auto& [mesh, halfedges, loops, face_source, start, least, crease, avoid] = chart;
  bytes.add_list(mesh.positions).add_list(mesh.faces).add_list(halfedges.twin);
  bytes.add(static_cast<std::uint32_t>(loops.size()));
  for (const BoundaryLoop& loop : loops) bytes.add_list(loop);
  bytes.add_list(face_source).add_list(start).add(static_cast<std::uint8_t>(least));
  bytes.add_list(crease).add_list(avoid);
}

PartReader::PartReader(const Chart& whole)
    : sources_(whole.face_source), left_(sources_.size()), is_used_(left_, 0) {
  std::ranges::sort(sources_);
}

Chart PartReader::next(ByteUnpacker& bytes) {
  Chart chart{.mesh = next_mesh(bytes), .halfedges = {}, .loops = {}, .face_source = {}};
  const std::size_t faces = chart.mesh.faces.size(), sides = 3 * faces;
  chart.halfedges = next_halfedges(bytes, faces);
  chart.loops = next_loops(bytes, chart.halfedges);
  chart.face_source = bytes.next_list<Index>();
  require(chart.face_source.size() == faces);
  for (const Index face : chart.face_source) {
    const auto at = std::ranges::lower_bound(sources_, face);
    require(at != sources_.end() && *at == face);
    require(!std::exchange(is_used_[static_cast<std::size_t>(at - sources_.begin())], 1));
  }
  left_ -= faces;
  chart.start = next_of_each<Vec2>(bytes, chart.mesh.positions.size());
  require(are_finite(chart.start));
  const auto least = bytes.next<std::uint8_t>();
  require(least <= static_cast<std::uint8_t>(Guarantee::bijective));
  chart.least = static_cast<Guarantee>(least);
  chart.crease = next_of_each<char>(bytes, sides);
  chart.avoid = next_of_each<double>(bytes, sides);
  require(std::ranges::all_of(chart.avoid, [](double own) { return std::isfinite(own); }));
  return chart;
}

void PartReader::require_all() const { require(left_ == 0); }

UvMap next_map(ByteUnpacker& bytes, std::size_t vertices) {
  auto map = bytes.next_list<Vec2>();
  require(map.size() == vertices && are_finite(map));
  return map;
}

}  // namespace unwrapd::charts
