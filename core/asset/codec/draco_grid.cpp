// Draco rounds v to floor((v - origin) * (2^bits - 1) / range + 0.5), in floats. With 24 bits and a
// range of 2^24 - 1 steps that is exact, as long as the sum with 0.5 is: whole numbers must stay
// below 2^23. So the origin of an exact grid lies in the middle of the values, and whole numbers
// have both signs, which Draco bears.
#include "core/asset/codec/draco_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/asset/gltf/elements.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::codec {
namespace {

constexpr int kExactBits = 24;
constexpr double kMostSteps = (1 << (kExactBits - 1)) - 1;  // from the origin
constexpr float kSteps = (1 << kExactBits) - 1;

std::array<float, 3> floats_at(const Elements& elements, std::size_t element,
                               std::size_t components) {
  std::array<float, 3> values = {};
  if (const char* bytes = elements.at(element))
    std::memcpy(values.data(), bytes, components * sizeof(float));
  return values;
}

struct Box {
  std::array<float, 3> low, high;
  bool is_float = true;
};

void extend(Box& box, const Gltf& gltf, std::size_t accessor) {
  const Elements elements(gltf, accessor);
  for (std::size_t i = 0; i < gltf.accessors[accessor].count; ++i) {
    check_cancelled_every(i, gltf.stop);
    const std::array<float, 3> point = floats_at(elements, i, 3);
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], point[k]);
      box.high[k] = std::max(box.high[k], point[k]);
    }
  }
}

/// The greatest power of two that divides the value, or infinity for 0.
double step_of(float value) {
  if (value == 0) return std::numeric_limits<double>::infinity();
  int exponent = 0;
  auto digits = static_cast<long>(std::ldexp(std::frexp(value, &exponent), kExactBits));
  for (exponent -= kExactBits; digits % 2 == 0; digits /= 2) ++exponent;
  return std::ldexp(1.0, exponent);
}

bool holds(const DracoGrid& grid, const Elements& elements, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<float, 3> value = floats_at(elements, i, 2);
    for (std::size_t k = 0; k < 2; ++k)
      if (grid.rounded(value[k], k) != value[k]) return false;
  }
  return true;
}

}  // namespace

float DracoGrid::rounded(float value, std::size_t component) const {
  const auto steps = static_cast<float>((std::int32_t{1} << bits) - 1);
  const float per_unit = steps / range, unit = range / steps;
  const float offset = (value - origin[component]) * per_unit;
  return std::floor(offset + 0.5F) * unit + origin[component];
}

std::map<std::size_t, DracoGrid> position_grids(const Gltf& gltf, int bits) {
  constexpr float most = std::numeric_limits<float>::max();
  std::map<std::size_t, Box> boxes;
  for (const Primitive& primitive : gltf.primitives) {
    if (!primitive.has_triangles) continue;
    Box& box = boxes.try_emplace(primitive.mesh, Box{{most, most, most}, {-most, -most, -most}})
                   .first->second;
    box.is_float = box.is_float && gltf.accessors[primitive.position].type == ComponentType::f32;
    if (box.is_float) extend(box, gltf, primitive.position);
  }
  std::map<std::size_t, DracoGrid> grids;
  for (const auto& [mesh, box] : boxes) {
    float range = 0;
    for (std::size_t k = 0; k < 3; ++k) range = std::max(range, box.high[k] - box.low[k]);
    if (box.is_float && range >= std::numeric_limits<float>::min() && range <= most)
      grids[mesh] = {box.low, range, bits};
  }
  return grids;
}

std::optional<DracoGrid> exact_grid(const Gltf& gltf, std::size_t accessor) {
  const std::size_t count = gltf.accessors[accessor].count;
  const Elements elements(gltf, accessor);
  double step = std::numeric_limits<double>::infinity();
  std::array<double, 2> low = {step, step}, high = {-step, -step};
  for (std::size_t i = 0; i < count; ++i) {
    check_cancelled_every(i, gltf.stop);
    const std::array<float, 3> value = floats_at(elements, i, 2);
    for (std::size_t k = 0; k < 2; ++k) {
      if (!std::isfinite(value[k])) return std::nullopt;
      step = std::min(step, step_of(value[k]));
      low[k] = std::min<double>(low[k], value[k]);
      high[k] = std::max<double>(high[k], value[k]);
    }
  }
  if (!std::isfinite(step)) return std::nullopt;
  DracoGrid grid{{}, static_cast<float>(kSteps * step), kExactBits};
  for (std::size_t k = 0; k < 2; ++k) {
    const double middle = step * std::floor((low[k] + high[k]) / 2 / step);
    if ((high[k] - middle) / step > kMostSteps) return std::nullopt;
    grid.origin[k] = static_cast<float>(middle);
  }
  return holds(grid, elements, count) ? std::optional(grid) : std::nullopt;
}

}  // namespace unwrapd::asset::codec
