#pragma once
// A stored mesh as its owner sees it, as JSON.

#include <cstdint>
#include <string>
#include <string_view>

#include "api/json.hpp"

namespace unwrapd::api {

struct Mesh {
  std::string sha256 = {};  ///< SHA-256 of its bytes in lowercase hex, which is its name
  std::int64_t bytes = 0;
  std::string media_type = {};  ///< as it was uploaded
  std::string created = {};     ///< RFC 3339, UTC
  std::string expires = {};     ///< RFC 3339, UTC: when it is removed unless it is used before
};

/// The path of a mesh: "/v1/meshes/" + sha256.
std::string mesh_path(std::string_view sha256);

/// With links{self}.
Json to_json(const Mesh& mesh);

}  // namespace unwrapd::api
