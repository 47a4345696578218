#pragma once
// Where an answer sends a GET on.

#include <string>
#include <string_view>

#include "client/server_url.hpp"

namespace unwrapd::client {

struct Destination {
  ServerUrl server;
  std::string path;  ///< below the server's prefix, with the query
};

bool is_redirect(int status);

/// What Location means in an answer of this server. The API key goes on to the same origin alone.
/// Throws Failure{unreachable} for what is no address.
Destination redirected(const ServerUrl& from, std::string_view location);

}  // namespace unwrapd::client
