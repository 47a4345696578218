// The origin is the centre of the bounding box, rounded to a multiple of a power of two of about
// the box's size. Floats hold such a number unless it is 2^24 times as large as the mesh.
#include "core/asset/convert/float_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "core/asset/base/as_size.hpp"
#include "core/asset/base/pace.hpp"
#include "core/base/error.hpp"

namespace unwrapd::asset::convert {
namespace {

constexpr double kMostMoved = 1e-5;    // of the diagonal
constexpr double kKeptEdge = 0x1p-22;  // of it: floats about the centre keep such edges

struct Extent {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;

  [[nodiscard]] double diagonal() const { return (high - low).stableNorm(); }
};

Extent box_of(const TriMesh& mesh, Pace& pace) {
  Extent box;
  for (const Triangle& face : mesh.faces) {
    pace.add(1);
    for (const Index v : face) {
      box.low = box.low.cwiseMin(mesh.positions[as_size(v)]);
      box.high = box.high.cwiseMax(mesh.positions[as_size(v)]);
    }
  }
  return box;
}

struct Rounding {
  double moved = 0;     ///< a coordinate, at most
  double longest = 0;   ///< edge that is lost, by its largest coordinate
  Index collapsed = 0;  ///< faces that lose an edge
};

/// What floats make of the positions relative to an origin.
Rounding rounding_about(const Vec3& origin, const TriMesh& mesh, Pace& pace) {
  Rounding rounding;
  for (const Triangle& face : mesh.faces) {
    pace.add(2);
    std::array<Vec3, 3> exact, rounded;
    for (std::size_t k = 0; k < 3; ++k) {
      exact[k] = mesh.positions[as_size(face[k])] - origin;
      rounded[k] = exact[k].cast<float>().cast<double>();
      rounding.moved = std::max(rounding.moved, (rounded[k] - exact[k]).cwiseAbs().maxCoeff());
    }
    double lost = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (rounded[k] == rounded[(k + 1) % 3])
        lost = std::max(lost, (exact[k] - exact[(k + 1) % 3]).cwiseAbs().maxCoeff());
    rounding.longest = std::max(rounding.longest, lost);
    rounding.collapsed += lost > 0 ? 1 : 0;
  }
  return rounding;
}

Vec3 origin_in(const Extent& box) {
  const double step = std::ldexp(1.0, std::ilogb(box.diagonal()));
  const Vec3 centre = box.low / 2 + box.high / 2;
  const auto rounded = [step](double x) { return std::round(x / step) * step + 0.0; };
  return {rounded(centre.x()), rounded(centre.y()), rounded(centre.z())};
}

/// "(500001, 5400001, 0)"
std::string shown(const Vec3& point) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "(%.15g, %.15g, %.15g)", point.x(), point.y(), point.z());
  return text.data();
}

std::string shown(double length) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", length);
  return text.data();
}

}  // namespace

FloatFrame float_frame(const TriMesh& mesh, const std::stop_token& stop) {
  Pace pace(stop);
  const Extent box = box_of(mesh, pace);
  const double diagonal = box.diagonal();
  const Rounding in_place = rounding_about(Vec3::Zero(), mesh, pace);
  const auto is_lossy = [&](const Rounding& rounding) {
    return rounding.moved > kMostMoved * diagonal || rounding.longest > kKeptEdge * diagonal;
  };
  if (!(diagonal > 0) || !is_lossy(in_place))
    return {Vec3::Zero(), in_place.moved, in_place.collapsed};
  const Vec3 origin = origin_in(box);
  const Rounding moved = rounding_about(origin, mesh, pace);
  if (is_lossy(moved))
    throw Error(ErrorCode::zero_area,
                "the mesh is too small for the floats of "
                "a glTF, in which it has no area; scale "
                "it, or send output=obj");
  return {origin, in_place.moved, moved.collapsed};
}

std::vector<Note> notes_on(const FloatFrame& frame) {
  std::vector<Note> notes;
  if (frame.origin != Vec3::Zero())
    notes.push_back({NoteCode::origin_moved,
                     "The positions in the result are relative to " + shown(frame.origin) +
                         ", the translation of its node. Floats, which glTF has, would "
                         "move them by up to " +
                         shown(frame.moved_in_place) + " so far from the origin."});
  if (frame.collapsed > 0)
    notes.push_back({NoteCode::positions_rounded, std::to_string(frame.collapsed) +
                                                      " faces are so small beside the mesh "
                                                      "that floats, which glTF has, make "
                                                      "one of two of their corners. Send "
                                                      "output=obj to keep all digits."});
  return notes;
}

}  // namespace unwrapd::asset::convert
