// Texels are counted in integers: texture coordinates are multiples of 2^-24, so the sign of a
// texel's middle against a side is exact, and a middle on a common side belongs to one of the two
// faces (the rule of rasterisers: left and lower sides are in). Gaps are distances between
// segments of borders, found by the cells of a grid as wide as the gap.
#include "tests/bench/written_atlas.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace unwrapd::bench {
namespace {

constexpr int kLatticeBits = 24;

Index root_of(std::vector<Index>& into, Index v) {
  while (into[std::size_t(v)] != v)
    v = into[std::size_t(v)] = into[std::size_t(into[std::size_t(v)])];
  return v;
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double signed_area(const CornerUv& uv) { return cross(uv[1] - uv[0], uv[2] - uv[0]) / 2; }

/// Charts are what hangs together by vertices; they are numbered by their first faces.
void number_charts(Index vertex_count, std::vector<WrittenFace>& faces) {
  std::vector<Index> into(std::size_t(vertex_count), 0), number(into.size(), -1);
  std::iota(into.begin(), into.end(), 0);
  for (const WrittenFace& face : faces)
    for (const Index v : face.vertex) into[root_of(into, v)] = root_of(into, face.vertex[0]);
  Index count = 0;
  for (WrittenFace& face : faces) {
    Index& own = number[std::size_t(root_of(into, face.vertex[0]))];
    if (own < 0) own = count++;
    face.chart = own;
  }
}

/// Of one face: the singular values of the map from space to the page by its first fundamental
/// form.
struct Stretch {
  double weight = 0, ratio = 0, area = 0;  ///< area in space, s1/s2 + s2/s1, s1 * s2

  explicit Stretch(const WrittenFace& face) {
    const Vec3 ab = face.position[1] - face.position[0], ac = face.position[2] - face.position[0];
    const Vec2 u = face.uv[1] - face.uv[0], v = face.uv[2] - face.uv[0];
    const double twice = ab.cross(ac).norm();
    weight = twice / 2;
    area = std::abs(cross(u, v)) / twice;
    const double squares = (u.squaredNorm() * ac.squaredNorm() - 2 * u.dot(v) * ab.dot(ac) +
                            v.squaredNorm() * ab.squaredNorm()) /
                           (twice * twice);
    ratio = squares / area;
  }
};

void measure_distortion(std::span<const WrittenFace> faces, WrittenAtlas& atlas) {
  double space = 0, page = 0, angle = 0, inverse = 0;
  for (const WrittenFace& face : faces) {
    const Stretch stretch(face);
    space += stretch.weight;
    page += stretch.weight * stretch.area;
    angle += stretch.weight * stretch.ratio;
    inverse += stretch.weight / stretch.area;
  }
  atlas.angle = angle / space;
  atlas.area = 1 + inverse * page / (space * space);
  atlas.fill = page;
}

struct Point {
  std::int64_t x, y;
};

/// Middles of texels that a face covers are counted in `covered`.
void cover(const CornerUv& uv, int texels, std::vector<std::uint8_t>& covered) {
  std::array<Point, 3> p{};
  for (std::size_t i = 0; i < 3; ++i)
    p[i] = {std::llround(std::ldexp(uv[i].x(), kLatticeBits)),
            std::llround(std::ldexp(uv[i].y(), kLatticeBits))};
  if ((p[1].x - p[0].x) * (p[2].y - p[0].y) < (p[1].y - p[0].y) * (p[2].x - p[0].x))
    std::swap(p[1], p[2]);
  const std::int64_t step = (std::int64_t{1} << kLatticeBits) / texels;
  const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
  const auto [low, high] = std::minmax({p[0].y, p[1].y, p[2].y});
  const auto is_inside = [&](std::int64_t x, std::int64_t y) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Point &a = p[i], &b = p[(i + 1) % 3];
      const std::int64_t side = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
      const bool is_in = b.y < a.y || (b.y == a.y && b.x > a.x);
      if (side < 0 || (side == 0 && !is_in)) return false;
    }
    return true;
  };
  const std::int64_t last = texels - 1;
  for (std::int64_t j = std::max<std::int64_t>(0, low / step); j <= std::min(last, high / step);
       ++j)
    for (std::int64_t i = std::max<std::int64_t>(0, left / step); i <= std::min(last, right / step);
         ++i)
      if (is_inside(i * step + step / 2, j * step + step / 2)) {
        std::uint8_t& own = covered[std::size_t(j * texels + i)];
        own = std::uint8_t(std::min(own + 1, 2));
      }
}

/// A side of a chart's border, in texels.
struct Side {
  Vec2 a, b;
  Index chart = 0;
};

std::vector<Side> borders(std::span<const WrittenFace> faces, double resolution) {
  std::map<std::array<Index, 2>, std::pair<int, Side>> sides;
  for (const WrittenFace& face : faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const auto [low, high] = std::minmax(face.vertex[i], face.vertex[j]);
      auto& [count, side] = sides[{low, high}];
      ++count;
      side = {resolution * face.uv[i], resolution * face.uv[j], face.chart};
    }
  std::vector<Side> border;
  for (const auto& [ends, side] : sides)
    if (side.first == 1) border.push_back(side.second);
  return border;
}

double distance(const Vec2& p, const Side& s) {
  const Vec2 along = s.b - s.a;
  const double length = along.squaredNorm();
  const double t = length > 0 ? std::clamp((p - s.a).dot(along) / length, 0.0, 1.0) : 0;
  return (s.a + t * along - p).norm();
}

double distance(const Side& s, const Side& t) {
  return std::min({distance(s.a, t), distance(s.b, t), distance(t.a, s), distance(t.b, s)});
}

class Grid {
 public:
  Grid(std::span<const Side> sides, double cell) : sides_(sides), cell_(cell) {
    for (std::size_t k = 0; k < sides.size(); ++k)
      for_each_cell(sides[k], 0, [&](const std::array<int, 2>& c) { cells_[c].push_back(k); });
  }

  /// To sides of other charts within a cell's width.
  [[nodiscard]] double least_distance(const Side& side, double most) const {
    for_each_cell(side, cell_, [&](const std::array<int, 2>& c) {
      const auto found = cells_.find(c);
      if (found == cells_.end()) return;
      for (const std::size_t k : found->second)
        if (sides_[k].chart != side.chart) most = std::min(most, distance(side, sides_[k]));
    });
    return most;
  }

 private:
  template <class Visit>
  void for_each_cell(const Side& side, double reach, Visit visit) const {
    const Vec2 low = (side.a.cwiseMin(side.b) - Vec2::Constant(reach)) / cell_;
    const Vec2 high = (side.a.cwiseMax(side.b) + Vec2::Constant(reach)) / cell_;
    for (int y = int(std::floor(low.y())); y <= int(std::floor(high.y())); ++y)
      for (int x = int(std::floor(low.x())); x <= int(std::floor(high.x())); ++x) visit({x, y});
  }

  std::span<const Side> sides_;
  double cell_;
  std::map<std::array<int, 2>, std::vector<std::size_t>> cells_;
};

double least_gap(std::span<const WrittenFace> faces, const WrittenRules& rules) {
  const std::vector<Side> sides = borders(faces, rules.resolution);
  const Grid grid(sides, rules.most_gap);
  double gap = rules.most_gap;
  for (const Side& side : sides) {
    for (const Vec2& p : {side.a, side.b})
      gap = std::min({gap, p.minCoeff(), rules.resolution - p.maxCoeff()});
    gap = grid.least_distance(side, gap);
  }
  return gap;
}

void count_signs(std::span<const WrittenFace> faces, WrittenAtlas& atlas) {
  std::map<Index, double> area;
  for (const WrittenFace& face : faces) {
    const double own = signed_area(face.uv);
    area[face.chart] += own;
    atlas.flips += own <= 0 ? 1 : 0;
  }
  atlas.charts = Index(area.size());
  for (const auto& [chart, own] : area) atlas.mirrored += own < 0 ? 1 : 0;
}

/// Vertices are one where place and texture coordinates are, whatever else the asset splits them
/// for.
Index number_of(const Vec3& p, const Vec2& uv, std::map<std::array<double, 5>, Index>& number) {
  const std::array key{p.x(), p.y(), p.z(), uv.x(), uv.y()};
  return number.try_emplace(key, Index(number.size())).first->second;
}

}  // namespace

std::vector<WrittenFace> written_faces(std::span<const Surface> surfaces,
                                       std::span<const UnwrappedSurface> unwrapped) {
  std::vector<WrittenFace> faces;
  std::set<std::array<Index, 3>> seen;
  std::map<std::array<double, 5>, Index> number;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const UnwrappedSurface& own = unwrapped[s];
    for (const Triangle& face : own.faces) {
      WrittenFace written;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto v = std::size_t(face[i]);
        written.position[i] = surfaces[s].mesh.positions[std::size_t(own.source[v])];
        written.uv[i] = own.uv[v];
        written.vertex[i] = number_of(written.position[i], written.uv[i], number);
      }
      std::array<Index, 3> sorted = written.vertex;
      std::ranges::sort(sorted);
      const auto& [a, b, c] = written.position;
      const bool has_area = (b - a).cross(c - a).norm() > 0 && signed_area(written.uv) != 0;
      if (has_area && seen.insert(sorted).second) faces.push_back(written);
    }
  }
  number_charts(Index(number.size()), faces);
  return faces;
}

WrittenAtlas measure_written(std::span<const WrittenFace> faces, const WrittenRules& rules) {
  WrittenAtlas atlas;
  measure_distortion(faces, atlas);
  count_signs(faces, atlas);
  std::vector<std::uint8_t> covered(std::size_t(rules.texels) * std::size_t(rules.texels), 0);
  for (const WrittenFace& face : faces) cover(face.uv, rules.texels, covered);
  atlas.overlapping_texels = std::ranges::count(covered, 2);
  atlas.gap = least_gap(faces, rules);
  return atlas;
}

}  // namespace unwrapd::bench
