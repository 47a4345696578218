#pragma once
// The parts of a multipart/form-data body (RFC 7578, RFC 2046 5.1), read as its bytes come. The
// work is linear in the bytes, and what is held of them is bounded: the head of one part, else
// fewer bytes than a delimiter has.
//
// Rejected: httplib's reader, whose regular expressions took 19 s of a processor for a part's head
// of 8 kB, and cannot be stopped.

#include <cstddef>
#include <string>
#include <string_view>

#include "server/http/http.hpp"

namespace unwrapd::server::http {

inline constexpr std::size_t kMaxBoundary = 70;  // RFC 2046, 5.1.1
inline constexpr std::size_t kMaxPartHead = std::size_t{8} * 1024;

/// What a Content-Disposition says of a part. Backslashes escape quotes and themselves alone, since
/// browsers and older programs send others as they are; `filename*` has no place in a form (RFC
/// 7578, 4.2) and is passed over. Throws Error{malformed_request}.
Part part_of_disposition(std::string_view value);

class FormParser {
 public:
  /// Throws Error{malformed_request} when there is no boundary, or too long a one.
  FormParser(std::string_view boundary, BodyReader::PartStart start, BodyReader::Sink sink);

  /// The next bytes of the body. Throws Error{malformed_request}, and what start and sink throw.
  void feed(std::string_view bytes);
  /// The body has ended. Throws Error{malformed_request} when the form has not.
  void finish() const;

 private:
  enum class State { before, after_delimiter, in_head, in_part, ended };

  bool step();
  bool pass_to_delimiter();
  bool choose_after_delimiter();
  bool read_head();
  void hand_out(std::size_t count);

  const std::string delimiter_;  // with the line end before it
  const BodyReader::PartStart start_;
  const BodyReader::Sink sink_;
  State state_ = State::before;
  std::string held_ = "\r\n";  // received and not yet used; a form may begin with its delimiter
  std::size_t searched_ = 0;   // of held_, for what is awaited
};

}  // namespace unwrapd::server::http
