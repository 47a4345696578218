#pragma once
// Connections, with and without TLS, that bound the head of an answer. The HTTP library reads lines
// of any length, and matches status lines with a recursive regular expression: 30 kB of one
// overflow the stack.

#include <httplib.h>

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace unwrapd::client {

/// Checks an answer's bytes as they arrive, up to the body.
class AnswerHead {
 public:
  /// False if a line or the whole head is too long. Interim answers (100) count as head.
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

class BoundedHttps : public httplib::SSLClient {
 public:
  using httplib::SSLClient::SSLClient;

 private:
  bool process_socket(const Socket& socket,
                      std::function<bool(httplib::Stream&)> callback) override;
};

}  // namespace unwrapd::client
