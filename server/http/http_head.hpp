#pragma once
// The head of a request (request line and header fields) is vetted before anything parses it: what
// two programs could read differently is refused, which is how requests are smuggled.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"

namespace unwrapd::server::http {

inline constexpr std::size_t kMaxHeadBytes = std::size_t{32} * 1024;
inline constexpr std::size_t kMaxLineBytes = std::size_t{8} * 1024 - 2;  // httplib's, without CRLF
inline constexpr int kMaxHeaderFields = 100;

/// How the body of a request is delimited, and what else is to be known before it is parsed.
struct Framing {
  bool chunked = false;
  std::int64_t content_length = 0;  ///< of a body that is not chunked
  bool awaits_continue = false;     ///< the sender waits for 100 before it sends the body
  std::size_t target = 0;           ///< where the request line's target begins
  std::size_t authority = 0;        ///< bytes of scheme and host before its path
  std::string query;                ///< of the target, percent-encoded
  std::string host;                 ///< of the target, else of the Host header; may be empty
  bool brings_body = false;         ///< by its method
  bool version_1_0 = false;         ///< knows no chunks
  bool gzip = false;                ///< the Content-Encoding of the body
  bool unknown_coding = false;      ///< its Content-Encoding is another one
  bool last = false;                ///< the sender wants no other answer on this connection
  /// Name and value of each header field, as they came: httplib percent-decodes what it hands on.
  std::vector<std::pair<std::string, std::string>> fields = {};
  /// Why a request that can be read is not taken: length_required, unsupported_media_type (a
  /// Content-Encoding), malformed_request (two values of what has one). What follows it is no
  /// other.
  std::optional<Error> refusal = std::nullopt;

  [[nodiscard]] bool has_body() const { return chunked || content_length > 0; }
};

/// Reads the framing from a head that ends with the empty line. Throws Error: malformed_request,
/// headers_too_large.
Framing vet_head(std::string_view head);

/// Whether a line after the last chunk, without its end, is a field under the rules of the head,
/// and none that tells where a request ends or whose it is.
bool is_trailer(std::string_view line);

/// Makes "GET http://host/path?query" "GET /path" in a head that was vetted (RFC 9112, 3.2.2),
/// since httplib reads queries otherwise than parse_query(), and leaves out every Range, which
/// httplib would match against a regular expression. Returns by how many bytes the head, which more
/// may follow, is shorter.
std::ptrdiff_t simplify(std::string& head, const Framing& framing);

}  // namespace unwrapd::server::http
