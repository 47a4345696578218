#pragma once
// A connection without TLS that takes no answer's head without end. The HTTP library reads lines
// as long as they come, and matches status lines against a regular expression that recurses for
// every byte: 30 kB of one overflow the stack.

#include <httplib.h>

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace unwrapd::client {

/// Sees an answer's bytes as they come in, up to the body.
class AnswerHead {
 public:
  /// False once a line or the whole head is too long. Interim answers (100) count for the head.
  bool takes(std::string_view bytes);

 private:
  bool ends_line();

  std::string line_;
  std::size_t size_ = 0;
  bool is_interim_ = false;
  bool is_over_ = false;
};

class BoundedHttp : public httplib::ClientImpl {
 public:
  using httplib::ClientImpl::ClientImpl;

 private:
  bool process_socket(const Socket& socket,
                      std::function<bool(httplib::Stream&)> callback) override;
};

}  // namespace unwrapd::client
