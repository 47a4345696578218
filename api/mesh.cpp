#include "api/mesh.hpp"

namespace unwrapd::api {

std::string mesh_path(std::string_view sha256) { return "/v1/meshes/" + std::string(sha256); }

Json to_json(const Mesh& mesh) {
  return {{"sha256", mesh.sha256},         {"bytes", mesh.bytes},
          {"media_type", mesh.media_type}, {"created", mesh.created},
          {"expires", mesh.expires},       {"links", {{"self", mesh_path(mesh.sha256)}}}};
}

}  // namespace unwrapd::api
