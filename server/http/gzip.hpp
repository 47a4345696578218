#pragma once
// gzip (RFC 1952) of bodies as they pass: requests are decoded and answers encoded in pieces, so
// that memory stays bounded. Rejected: compressed copies of results on disk, which cost room in
// every quota, while level 1 compresses faster than most clients receive.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/http/http.hpp"

namespace unwrapd::server::http {

/// Up to here a body may unpack to any multiple of its size, beyond it to kMaxGzipRatio times.
inline constexpr std::int64_t kFreeUnpackedBytes = std::int64_t{16} << 20;
inline constexpr std::int64_t kMaxGzipRatio = 100;

/// Decodes a body of one or more members.
class GzipDecoder {
 public:
  /// max_bytes: of what is decoded.
  GzipDecoder(std::int64_t max_bytes, BodyReader::Sink sink);

  /// The next bytes of the body. Throws Error: malformed_request, body_too_large; and what the sink
  /// throws.
  void feed(std::string_view bytes);
  /// The body has ended. Throws Error{malformed_request} if it ends within a member.
  void finish() const;

 private:
  void begin_member_if_needed();
  void hand_out(std::string_view bytes);

  struct Stream;
  const std::unique_ptr<Stream, void (*)(Stream*)> stream_;
  const std::int64_t max_bytes_;
  const BodyReader::Sink sink_;
  std::int64_t received_ = 0, decoded_ = 0;
  bool in_member_ = false, ended_ = false;  // within a member; a member is complete
};

/// Encodes one member.
class GzipEncoder {
 public:
  GzipEncoder();

  /// What is ready after more bytes, often nothing; the rest once they are the last.
  std::string add(std::string_view bytes, bool last);

 private:
  struct Stream;
  const std::unique_ptr<Stream, void (*)(Stream*)> stream_;
};

/// Reads a file and compresses it: the next piece, which may be empty, until one is the end.
/// Nothing if the file is shorter than it was.
std::function<std::optional<StreamPiece>()> gzip_pieces(const FileBody& file);

/// Applies Accept-Encoding to a finished answer: a whole text or file of a kind that compresses is
/// sent as gzip, under an ETag of its own. Parts of a file and streams of events are left alone.
void encode_answer(const Request& request, Response& response);

/// The ETag of the same bytes as gzip: "abc-gzip" for "abc".
std::string gzip_etag(std::string_view etag);

}  // namespace unwrapd::server::http
