#include "server/uploads/mesh_reference.hpp"

#include "api/options.hpp"
#include "core/base/error.hpp"
#include "server/base/errors.hpp"
#include "server/base/identity.hpp"
#include "server/uploads/job_name.hpp"

namespace unwrapd::server::uploads {
namespace {

constexpr std::size_t kMaxBytes = api::kMaxOptionsBytes + 1024;

std::string mesh_of(const api::Json& value) {
  if (!value.is_string() || !is_sha256(value.get_ref<const std::string&>()))
    refuse_option("mesh", "mesh must be a SHA-256; send its 64 lowercase hex digits.");
  return value;
}

std::string source_of(const api::Json& value) {
  if (!value.is_string()) refuse_option("source", "source must be an address; send a string.");
  std::string source = value;
  if (source.empty()) refuse_option("source", "source is empty; send the address of a mesh.");
  return source;
}

std::string name_of(const api::Json& value) {
  if (!value.is_string()) refuse_option(kNameParameter, "The name of a job must be a string.");
  return checked_job_name(value);
}

std::string options_of(const api::Json& value) {
  if (!value.is_object()) refuse_option("options", "The options must be a JSON object.");
  return value.dump();
}

}  // namespace

MeshReference parse_mesh_reference(std::string_view text) {
  const api::Json json = api::parse_json(text, {.max_bytes = kMaxBytes});
  if (!json.is_object()) {
    throw Error(ErrorCode::malformed_request,
                "The body is not a JSON object; send {\"mesh\": SHA-256, \"options\": {...}}.");
  }
  MeshReference reference;
  for (const auto& [member, value] : json.items()) {
    if (member == "mesh") {
      reference.sha256 = mesh_of(value);
    } else if (member == "source") {
      reference.source = source_of(value);
    } else if (member == kNameParameter) {
      reference.name = name_of(value);
    } else if (member == "options") {
      reference.options = options_of(value);
    } else {
      refuse_option(
          member,
          "The JSON has an unknown member; its members are mesh or source, name and options.");
    }
  }
  if (reference.sha256.empty() && reference.source.empty())
    refuse_option("mesh",
                  "The member mesh is missing; send the SHA-256 of a stored mesh, or an address as "
                  "source.");
  if (!reference.sha256.empty() && !reference.source.empty())
    refuse_option("source", "mesh and source name two meshes; send one of them.");
  return reference;
}

void receive_reference_text(http::BodyReader& body, SpooledText& text) {
  body.read([&](std::string_view bytes) {
    if (text.size() + bytes.size() > kMaxBytes)
      throw Error(ErrorCode::body_too_large, "The JSON exceeds 16 MiB; shorten the options.");
    text.append(bytes);
  });
}

}  // namespace unwrapd::server::uploads
