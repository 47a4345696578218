#include "server/http/http_probe.hpp"

#include <httplib.h>

#include <chrono>
#include <cstdio>

namespace unwrapd::server::http {
namespace {

constexpr std::chrono::seconds kPatience{2};

/// The address under which a server that listens on all interfaces is reached from here.
std::string reachable(const std::string& host) {
  if (host == "0.0.0.0") return "127.0.0.1";
  return host == "::" ? "::1" : host;
}

}  // namespace

int probe(const Address& admin) {
  httplib::Client client(reachable(admin.host), admin.port);
  client.set_connection_timeout(kPatience);
  client.set_read_timeout(kPatience);
  const httplib::Result answer = client.Get("/healthz");
  if (answer && answer->status == 200) return 0;
  const std::string reason =
      answer ? "status " + std::to_string(answer->status) : httplib::to_string(answer.error());
  std::fprintf(stderr, "unwrapd: no health at %s: %s\n", to_text(admin).c_str(), reason.c_str());
  return 1;
}

}  // namespace unwrapd::server::http
