#include "api/constraints.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "core/base/error.hpp"

namespace unwrapd::api {
namespace {

constexpr std::array<std::string_view, 5> kMembers = {"vertex", "at", "uv", "weight", "mesh"};

[[noreturn]] void refuse(const std::string& pointer, const std::string& message) {
  throw Error(ErrorCode::invalid_option, message, pointer);
}

/// One constraint of the request.
struct Source {
  const Json& object;
  const std::string& pointer;

  [[nodiscard]] const Json* find(const char* name) const {
    const auto found = object.find(name);
    return found == object.end() || found->is_null() ? nullptr : &*found;
  }
  [[noreturn]] void refuse(const char* name, const std::string& message) const {
    api::refuse(pointer + "/" + name, message);
  }
};

void check_members(const Source& source) {
  if (!source.object.is_object())
    refuse(source.pointer, "A constraint must be an object with vertex or at, and uv.");
  for (const auto& [name, value] : source.object.items()) {
    bool known = false;
    for (const std::string_view member : kMembers) known = known || name == member;
    if (!known)
      refuse(source.pointer + "/" + pointer_token(name),
             "A constraint has no such member; its members are vertex, at, uv, weight, mesh.");
  }
}

Index index_of(const Source& source, const char* name, const Json& value) {
  const std::optional<Index> index = index_in(value);
  if (!index) source.refuse(name, std::string(name) + " must be an integer of at least 0.");
  return *index;
}

/// Finite, since the parser refuses other numbers.
template <class Vector>
Vector vector_of(const Source& source, const char* name, const Json& value) {
  Vector vector;
  if (!read_numbers(value, {vector.data(), static_cast<std::size_t>(vector.size())}))
    source.refuse(name, std::string(name) + " must be a list of " + std::to_string(vector.size()) +
                            " finite numbers.");
  return vector;
}

double weight_of(const Source& source, const Json& value) {
  const double weight = value.is_number() ? value.get<double>() : 0;
  if (!(weight >= kMinConstraintWeight && weight <= kMaxConstraintWeight))
    source.refuse(
        "weight",
        "weight must be a number from 1e-9 to 1e9; leave it out to fix the vertex exactly.");
  return weight;
}

PositionConstraint constraint_of(const Source& source) {
  check_members(source);
  PositionConstraint constraint;
  const Json* vertex = source.find("vertex");
  const Json* at = source.find("at");
  if (vertex != nullptr && at != nullptr)
    refuse(source.pointer, "A constraint has vertex or at, not both: leave one out.");
  if (vertex == nullptr && at == nullptr)
    refuse(source.pointer, "A constraint must name its vertex by vertex or at.");
  if (vertex != nullptr) constraint.vertex = index_of(source, "vertex", *vertex);
  if (at != nullptr) constraint.position = vector_of<Vec3>(source, "at", *at);
  const Json* uv = source.find("uv");
  constraint.uv = vector_of<Vec2>(source, "uv", uv != nullptr ? *uv : Json());
  if (const Json* weight = source.find("weight")) constraint.weight = weight_of(source, *weight);
  if (const Json* mesh = source.find("mesh")) constraint.surface = index_of(source, "mesh", *mesh);
  return constraint;
}

Json to_json(const PositionConstraint& constraint) {
  Json json = Json::object();
  const Vec3& at = constraint.position;
  if (constraint.vertex) {
    json["vertex"] = *constraint.vertex;
  } else {
    json["at"] = {at.x(), at.y(), at.z()};
  }
  json["uv"] = {constraint.uv.x(), constraint.uv.y()};
  json["weight"] = std::isfinite(constraint.weight) ? Json(constraint.weight) : Json();
  json["mesh"] = constraint.surface;
  return json;
}

}  // namespace

std::vector<PositionConstraint> constraints_from_json(const Json& json, int most,
                                                      const std::string& pointer) {
  if (!json.is_array()) refuse(pointer, "constraints must be a list of objects.");
  if (json.size() > static_cast<std::size_t>(most))
    refuse(pointer, "constraints must have at most " + std::to_string(most) + " entries.");
  std::vector<PositionConstraint> constraints;
  constraints.reserve(json.size());
  for (std::size_t k = 0; k < json.size(); ++k)
    constraints.push_back(constraint_of({json[k], pointer + "/" + std::to_string(k)}));
  return constraints;
}

Json to_json(const std::vector<PositionConstraint>& constraints) {
  Json json = Json::array();
  for (const PositionConstraint& constraint : constraints) json.push_back(to_json(constraint));
  return json;
}

}  // namespace unwrapd::api
