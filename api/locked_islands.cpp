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

IslandAtFace island_of(const Json& object, const std::string& pointer) {
  if (!object.is_object() || !object.contains("face"))
    refuse_island(pointer, "An island of locked_islands must be an object with a face.");
  IslandAtFace island;
  for (const auto& [name, value] : object.items()) {
    const std::string at = pointer + "/" + pointer_token(name);
    if (name == "face")
      island.face = number_of(value, at);
    else if (name == "mesh")
      island.surface = number_of(value, at);
    else
      refuse_island(at,
                    "An island of locked_islands has no such member; its members are face and "
                    "mesh.");
  }
  return island;
}

}  // namespace

std::vector<IslandAtFace> locked_islands_from_json(const Json& json, const std::string& pointer) {
  if (!json.is_array()) refuse_island(pointer, "locked_islands must be a list of objects.");
  std::vector<IslandAtFace> islands;
  islands.reserve(json.size());
  for (std::size_t k = 0; k < json.size(); ++k)
    islands.push_back(island_of(json[k], pointer + "/" + std::to_string(k)));
  return islands;
}

Json to_json(const std::vector<IslandAtFace>& islands) {
  Json json = Json::array();
  for (const auto& [surface, face] : islands) json.push_back({{"face", face}, {"mesh", surface}});
  return json;
}

}  // namespace unwrapd::api
