#pragma once
// The only place that knows cpp-httplib: requests of one connection are parsed,
// handed to the answer function as plain values, and their answers written.
// httplib is used without its sockets and its threads, both of which are ours
// (connection.hpp, http_server.hpp); one small object of it a connection spares
// every handler a look-up of which connection it serves.

#include <memory>

#include "server/addresses.hpp"
#include "server/connection.hpp"
#include "server/http.hpp"
#include "server/log.hpp"

namespace unwrapd::server {

/// What an exchange needs of the server.
struct HttpUses {
  Handler answer;                   ///< called from many threads; must not throw
  Observer observe;                 ///< told of every answer, after it; the same
  AddressSet trusted_proxies = {};  ///< whose X-Forwarded-For is believed
};

class Exchange {
 public:
  /// All three must outlive it.
  Exchange(Connection& connection, const HttpUses& uses, const Log& log);
  ~Exchange();

  /// Answers the request whose head the connection has just vetted; last: no
  /// other may follow. True when another may.
  bool answer_request(bool last);

 private:
  class Http;
  std::unique_ptr<Http> http_;
};

}  // namespace unwrapd::server
