// The shell is a bowl of circles that grow from the hole to the rim, ruffled towards the rim: with
// a = kBend r the angle from the pole, its profile is (sin a, cos a), bent by more than a right
// angle, and its radius and height follow sin and cos of 7 t + 3 r. Such a surface cannot be laid
// flat without distortion, which makes the difference between the methods visible.
#include "client/sample.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

namespace unwrapd::client {
namespace {

using Json = nlohmann::ordered_json;
using Point = std::array<float, 3>;

constexpr int kRings = 71;
constexpr int kSegments = 142;
constexpr double kHoleRadius = 0.16;
constexpr double kBend = 1.75;  // of the profile from the pole to the rim, radians
constexpr double kRuffle = 0.15;

struct Shell {
  std::vector<Point> positions;
  std::vector<Point> normals;
  std::vector<std::uint16_t> indices;
};

/// r: 0 at the pole, 1 at the rim; t: around, in radians.
Point shell_point(double r, double t) {
  const double bend = kBend * r;
  const double ruffle = kRuffle * r * r * r * r;
  const double phase = 7 * t + 3 * r;
  const double radius = std::sin(bend) * (1 + ruffle * std::sin(phase));
  const double x = 0.2 * (1 - r) + radius * std::cos(t);
  const double y = 0.1 * (1 - r) + radius * std::sin(t);
  const double z = 1.2 * std::cos(bend) + 0.8 * ruffle * std::cos(phase);
  return {static_cast<float>(x), static_cast<float>(z), static_cast<float>(-y)};  // Y is up
}

/// The cross product of the surface's two tangents, by central differences.
Point shell_normal(double r, double t) {
  constexpr double step = 1e-3;
  const auto tangent = [](const Point& from, const Point& to) {
    return std::array<double, 3>{to[0] - from[0], to[1] - from[1], to[2] - from[2]};
  };
  const auto a = tangent(shell_point(r - step, t), shell_point(r + step, t));
  const auto b = tangent(shell_point(r, t - step), shell_point(r, t + step));
  const std::array<double, 3> n = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                   a[0] * b[1] - a[1] * b[0]};
  const double length = std::hypot(n[0], n[1], n[2]);
  return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length),
          static_cast<float>(n[2] / length)};
}

void add_vertices(Shell& shell) {
  for (int ring = 0; ring <= kRings; ++ring) {
    const double r = kHoleRadius + (1 - kHoleRadius) * ring / kRings;
    for (int segment = 0; segment < kSegments; ++segment) {
      const double t = 2 * std::numbers::pi * segment / kSegments;
      shell.positions.push_back(shell_point(r, t));
      shell.normals.push_back(shell_normal(r, t));
    }
  }
}

void add_faces(Shell& shell) {
  const auto at = [](int ring, int segment) {
    return static_cast<std::uint16_t>(ring * kSegments + segment % kSegments);
  };
  for (int ring = 0; ring < kRings; ++ring) {
    for (int segment = 0; segment < kSegments; ++segment) {
      const std::uint16_t a = at(ring, segment);
      const std::uint16_t b = at(ring + 1, segment);
      const std::uint16_t c = at(ring + 1, segment + 1);
      const std::uint16_t d = at(ring, segment + 1);
      shell.indices.insert(shell.indices.end(), {a, b, c, a, c, d});
    }
  }
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  static_assert(std::endian::native == std::endian::little, "glTF is little-endian");
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

Json bounds(const std::vector<Point>& points, bool upper) {
  Point bound = points.front();
  for (const Point& point : points)
    for (std::size_t k = 0; k < 3; ++k)
      bound[k] = upper ? std::max(bound[k], point[k]) : std::min(bound[k], point[k]);
  return Json(bound);
}

Json document(const Shell& shell) {
  constexpr int float_type = 5126, short_type = 5123, vertex_target = 34962, index_target = 34963;
  const std::size_t points = shell.positions.size() * sizeof(Point);
  const std::size_t indices = shell.indices.size() * sizeof(std::uint16_t);
  const auto view = [](std::size_t offset, std::size_t length, int target) {
    return Json{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}, {"target", target}};
  };
  const auto accessor = [](int buffer_view, int type, std::size_t count, const char* shape) {
    return Json{
        {"bufferView", buffer_view}, {"componentType", type}, {"count", count}, {"type", shape}};
  };
  Json position = accessor(0, float_type, shell.positions.size(), "VEC3");
  position["min"] = bounds(shell.positions, false);
  position["max"] = bounds(shell.positions, true);
  Json json;
  json["asset"] = {{"version", "2.0"}, {"generator", "unwrap --sample"}};
  json["scene"] = 0;
  json["scenes"] = {{{"nodes", {0}}}};
  json["nodes"] = {{{"mesh", 0}, {"name", "shell"}}};
  json["materials"] = {{{"name", "shell"}, {"doubleSided", true}}};
  json["meshes"] = Json::array({Json{{"name", "shell"}}});
  json["meshes"][0]["primitives"] = Json::array(
      {Json{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}, {"material", 0}}});
  json["accessors"] = {position, accessor(1, float_type, shell.normals.size(), "VEC3"),
                       accessor(2, short_type, shell.indices.size(), "SCALAR")};
  json["bufferViews"] = {view(0, points, vertex_target), view(points, points, vertex_target),
                         view(2 * points, indices, index_target)};
  json["buffers"] = Json::array({Json{{"byteLength", 2 * points + indices}}});
  return json;
}

std::string word(std::size_t value) {
  return bytes_of(std::vector<std::uint32_t>{static_cast<std::uint32_t>(value)});
}

std::string padded(std::string bytes, char filler) {
  bytes.resize((bytes.size() + 3) / 4 * 4, filler);
  return bytes;
}

}  // namespace

std::string sample_glb() {
  Shell shell;
  add_vertices(shell);
  add_faces(shell);
  const std::string json = padded(document(shell).dump(), ' ');
  const std::string buffer =
      padded(bytes_of(shell.positions) + bytes_of(shell.normals) + bytes_of(shell.indices), '\0');
  const std::size_t total = 12 + 8 + json.size() + 8 + buffer.size();
  return "glTF" + word(2) + word(total) + word(json.size()) + "JSON" + json + word(buffer.size()) +
         std::string("BIN\0", 4) + buffer;
}

}  // namespace unwrapd::client
