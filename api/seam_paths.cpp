#include "api/seam_paths.hpp"

#include <optional>

#include "core/base/error.hpp"

namespace unwrapd::api {
namespace {

[[noreturn]] void refuse(const std::string& pointer, const std::string& message) {
  throw Error(ErrorCode::invalid_option, message, pointer);
}

/// The option that the pointer is in.
std::string option_of(const std::string& pointer) {
  return pointer.substr(1, pointer.find('/', 1) - 1);
}

Index index_of(const Json& value, const std::string& pointer) {
  const std::optional<Index> index = index_in(value);
  if (!index)
    refuse(pointer,
           "Meshes and vertices of " + option_of(pointer) + " must be integers of at least 0.");
  return *index;
}

std::vector<Index> vertices_of(const Json& list, const std::string& pointer) {
  if (!list.is_array() || list.size() < 2)
    refuse(pointer, "vertices must be a list of two vertices or more.");
  std::vector<Index> vertices;
  vertices.reserve(list.size());
  for (std::size_t k = 0; k < list.size(); ++k)
    vertices.push_back(index_of(list[k], pointer + "/" + std::to_string(k)));
  return vertices;
}

SeamPath path_of(const Json& object, const std::string& pointer) {
  if (!object.is_object() || !object.contains("vertices"))
    refuse(pointer, "A path of " + option_of(pointer) + " must be an object with vertices.");
  SeamPath path;
  for (const auto& [name, value] : object.items()) {
    const std::string at = pointer + "/" + pointer_token(name);
    if (name == "vertices")
      path.vertices = vertices_of(value, at);
    else if (name == "mesh")
      path.surface = index_of(value, at);
    else
      refuse(at, "A path of " + option_of(pointer) +
                     " has no such member; its members are vertices and mesh.");
  }
  return path;
}

}  // namespace

std::vector<SeamPath> seam_paths_from_json(const Json& json, const std::string& option) {
  const std::string pointer = "/" + option;
  if (!json.is_array()) refuse(pointer, option + " must be a list of objects.");
  std::vector<SeamPath> paths;
  paths.reserve(json.size());
  for (std::size_t k = 0; k < json.size(); ++k)
    paths.push_back(path_of(json[k], pointer + "/" + std::to_string(k)));
  return paths;
}

Json to_json(const std::vector<SeamPath>& paths) {
  Json json = Json::array();
  for (const SeamPath& path : paths)
    json.push_back({{"vertices", path.vertices}, {"mesh", path.surface}});
  return json;
}

}  // namespace unwrapd::api
