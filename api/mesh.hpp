#pragma once
// A stored mesh as its owner sees it, as JSON.

#include <cstdint>
#include <string>
#include <string_view>

#include "api/json.hpp"

namespace unwrapd::api {

struct Mesh {
  std::string sha256 = {};  ///< of its bytes, lowercase hex: its name
  std::int64_t bytes = 0;
  std::string media_type = {};  ///< as it was sent
  std::string created = {};     ///< RFC 3339, UTC
  std::string expires = {};     ///< the same; when it goes unless it is used before
};

/// The path of a mesh: "/v1/meshes/" + sha256.
std::string mesh_path(std::string_view sha256);

/// With links{self}.
Json to_json(const Mesh& mesh);

}  // namespace unwrapd::api
