#pragma once
// The head of a request (request line and header fields) is vetted before anything parses it: what
// two programs could read differently is refused, which is how requests are smuggled.

#include <cstdint>
#include <string_view>

namespace unwrapd::server {

inline constexpr std::size_t kMaxHeadBytes = std::size_t{32} * 1024;
inline constexpr std::size_t kMaxLineBytes = std::size_t{8} * 1024 - 2;  // httplib's, without CRLF
inline constexpr int kMaxHeaderFields = 100;

/// How the body of a request is delimited.
struct Framing {
  bool chunked = false;
  std::int64_t content_length = 0;  ///< of a body that is not chunked

  [[nodiscard]] bool has_body() const { return chunked || content_length > 0; }
};

/// Reads the framing from a head that ends with the empty line. Throws Error: malformed_request,
/// length_required, headers_too_large, unsupported_media_type (a Content-Encoding).
Framing vet_head(std::string_view head);

}  // namespace unwrapd::server
