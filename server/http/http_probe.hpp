#pragma once
// Asks a running server whether it is well, for supervisors in images without a shell or curl.

#include "server/http/addresses.hpp"

namespace unwrapd::server::http {

/// The exit code of --healthcheck: 0 when GET /healthz at this address is answered with 200 within
/// two seconds, else 1, and stderr tells why.
int probe(const Address& admin);

}  // namespace unwrapd::server::http
