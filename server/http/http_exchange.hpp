#pragma once
// The only place that knows cpp-httplib: requests are parsed, handed to the
// answer function as plain values, and their answers written. httplib is used
// without its sockets and its threads, both of which are ours (connection.hpp,
// http_server.hpp); one object of it for each thread that answers spares every
// handler a look-up of which connection it serves. Rejected: one for each
// connection, whose routes (regular expressions) cost more than most requests.

#include <chrono>
#include <memory>
#include <optional>

#include "server/base/log.hpp"
#include "server/base/wakeup.hpp"
#include "server/http/addresses.hpp"
#include "server/http/connection.hpp"
#include "server/http/http.hpp"
#include "server/http/stream_writer.hpp"

namespace unwrapd::server::http {

/// What an exchange needs of the server.
struct HttpUses {
  Handler answer;                   ///< called from many threads; must not throw
  Observer observe;                 ///< told of every answer, after it; the same
  AddressSet trusted_proxies = {};  ///< whose X-Forwarded-For is believed
  /// Rung when the body of a stream may have more; for one server alone.
  std::shared_ptr<Wakeup> news = std::make_shared<Wakeup>();
};

/// Not for use by two threads at once.
class Exchange {
 public:
  /// Both must outlive it. idle: for so long a client is told that it may wait between requests.
  Exchange(const HttpUses& uses, const Log& log, std::chrono::milliseconds idle);
  ~Exchange();

  /// Answers the request whose head the connection has just vetted; last: no
  /// other may follow. True when another may; false, too, when of a stream
  /// only the head is out.
  bool answer_request(Connection& connection, bool last);
  /// The stream that the last answer began, if it did: its body is to be sent, and it is not yet
  /// observed.
  std::optional<OpenStream> take_stream();

 private:
  class Http;
  std::unique_ptr<Http> http_;
};

}  // namespace unwrapd::server::http
