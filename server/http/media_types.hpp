#pragma once
// What a request is, and what its sender wants: Content-Type, Accept, Prefer and Range.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace unwrapd::server::http {

/// Whether a client that sends this Accept-Encoding wants a coding, "br"; empty is no.
bool accepts_coding(std::string_view accept_encoding, std::string_view coding);

/// The same for gzip.
bool accepts_gzip(std::string_view accept_encoding);

enum class BodyKind { asset, multipart, reference };

/// Throws Error{unsupported_media_type} for anything but an asset's types, multipart/form-data, and
/// JSON, which names a stored mesh.
BodyKind body_kind(std::string_view content_type);

/// The boundary of a form's parts, without quotes; empty for other types, and where none is told.
std::string multipart_boundary(std::string_view content_type);

/// Of a result format: glb, gltf, obj or json.
std::string_view media_type(std::string_view format);

/// The format that an Accept header asks for; what it leaves open is `usual`, the job's own. Throws
/// Error{not_acceptable}.
std::string choose_format(std::string_view accept, std::string_view usual);

/// Whether an Accept header asks for events rather than JSON: it names them, and likes JSON less or
/// does not name it as exactly.
bool prefers_events(std::string_view accept);

/// N of "Prefer: wait=N"; empty when there is no such preference.
std::optional<int> preferred_wait(std::string_view prefer);

struct ByteRange {
  std::int64_t offset = 0;
  std::int64_t length = 0;
};

/// The one range of bytes that a Range header names within size bytes; empty when it names none,
/// several, or none that there is, in which case all bytes are sent.
std::optional<ByteRange> single_range(std::string_view range, std::int64_t size);

}  // namespace unwrapd::server::http
