#pragma once
// HTTP calls with plain types; only http.cpp includes the HTTP library.

#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <string_view>

#include "client/server_url.hpp"
#include "client/upload.hpp"

namespace unwrapd::client {

using Headers = std::map<std::string, std::string>;

/// headers: names in lower case.
struct Reply {
  int status = 0;
  Headers headers;
  std::string body;

  [[nodiscard]] bool ok() const { return status >= 200 && status < 300; }
  /// Empty if there is no such header. name: in lower case.
  [[nodiscard]] std::string header(const std::string& name) const;
};

/// Called with each part of a body.
using BytesSink = std::function<void(std::string_view)>;

/// Every call opens a connection of its own. It throws Failure{unreachable} if the server cannot be
/// reached or falls silent, Failure{interrupted} if a stop is requested, and what its sink or its
/// upload's files throw. A refusal (status 4xx, 5xx) is a Reply.
class Http {
 public:
  Http(ServerUrl server, std::stop_token stop);

  [[nodiscard]] Reply post(const std::string& path, const Upload& upload,
                           const Headers& headers) const;

  /// The body of a 2xx answer goes to sink, if given; any other body to the Reply. Follows a few
  /// redirects; the API key is sent to the server's own origin alone.
  [[nodiscard]] Reply get(const std::string& path, const Headers& headers = {},
                          const BytesSink& sink = {}) const;

  [[nodiscard]] Reply remove(const std::string& path) const;

  [[nodiscard]] const ServerUrl& server() const { return server_; }

 private:
  [[nodiscard]] Reply get_from(const ServerUrl& server, const std::string& path,
                               const Headers& headers, const BytesSink& sink) const;

  ServerUrl server_;
  std::stop_token stop_;
};

}  // namespace unwrapd::client
