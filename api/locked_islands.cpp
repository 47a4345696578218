#include "api/locked_islands.hpp"

#include <optional>

#include "core/base/error.hpp"

namespace unwrapd::api {
namespace {

[[noreturn]] void refuse_island(const std::string& pointer, const std::string& message) {
  throw Error(ErrorCode::invalid_option, message, pointer);
}

Index number_of(const Json& value, const std::string& pointer) {
  const std::optional<Index> number = index_in(value);
  if (!number)
    refuse_island(pointer, "Meshes and faces of locked_islands must be integers of at least 0.");
  return *number;
}

LockedIsland island_of(const Json& object, const std::string& pointer) {
  if (!object.is_object() || !object.contains("face"))
    refuse_island(pointer, "An island of locked_islands must be an object with a face.");
  LockedIsland island;
  for (const auto& [name, value] : object.items()) {
    const std::string at = pointer + "/" + pointer_token(name);
    if (name == "face") {
      island.face = number_of(value, at);
    } else if (name == "mesh") {
      island.surface = number_of(value, at);
    } else if (name == "turn") {
      if (!value.is_number()) refuse_island(at, "turn must be a number of degrees.");
      island.turn = value.get<double>();
    } else if (name == "move") {
      if (!read_numbers(value, {island.move.data(), 2}))
        refuse_island(at, "move must be a list of 2 finite numbers, along U and V.");
    } else {
      refuse_island(at,
                    "An island of locked_islands has no such member; its members are face, mesh, "
                    "turn and move.");
    }
  }
  return island;
}

}  // namespace

std::vector<LockedIsland> locked_islands_from_json(const Json& json, const std::string& pointer) {
  if (!json.is_array()) refuse_island(pointer, "locked_islands must be a list of objects.");
  std::vector<LockedIsland> islands;
  islands.reserve(json.size());
  for (std::size_t k = 0; k < json.size(); ++k)
    islands.push_back(island_of(json[k], pointer + "/" + std::to_string(k)));
  return islands;
}

Json to_json(const std::vector<LockedIsland>& islands) {
  Json json = Json::array();
  for (const LockedIsland& island : islands) {
    Json& object = json.emplace_back(Json{{"face", island.face}, {"mesh", island.surface}});
    if (island.stays()) continue;
    object["turn"] = island.turn;
    object["move"] = {island.move.x(), island.move.y()};
  }
  return json;
}

}  // namespace unwrapd::api
