#pragma once
// A request for a job that names a stored mesh, {"mesh": SHA-256, "name": TEXT, "options": {...}},
// or, with `source` in place of `mesh`, the address of one.

#include <optional>
#include <string>
#include <string_view>

#include "server/http/http.hpp"
#include "server/uploads/spooled_text.hpp"

namespace unwrapd::server::uploads {

struct MeshReference {
  std::string sha256;                  ///< of a stored mesh, or
  std::string source;                  ///< an address, unchecked
  std::string name;                    ///< of the job; empty for none
  std::optional<std::string> options;  ///< JSON text, where there are any
};

/// Throws Error: malformed_request for what is no JSON object; invalid_option with the pointer of a
/// member that is missing, unknown, given twice or of another type.
MeshReference parse_mesh_reference(std::string_view text);

/// Such a text, unread. Throws what BodyReader and SpooledText throw.
void receive_reference_text(http::BodyReader& body, SpooledText& text);

}  // namespace unwrapd::server::uploads
