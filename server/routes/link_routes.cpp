#include "server/routes/link_routes.hpp"

#include <algorithm>
#include <array>

#include "server/base/clock.hpp"
#include "server/base/errors.hpp"
#include "server/base/identity.hpp"
#include "server/http/query.hpp"

namespace unwrapd::server::routes {
namespace {

constexpr auto kLinked = std::to_array<std::string_view>(
    {"result", "report", "layout.svg", "layout.png", "preview.png", "events", "job"});
constexpr std::int64_t kDay = 24 * 3600;  // seconds
constexpr std::int64_t kUsualSeconds = 3600;
constexpr std::int64_t kMostSeconds = 7 * kDay;
constexpr std::int64_t kUsualTicketSeconds = 900;
constexpr std::int64_t kMostTickets = 100;  // of one call
constexpr std::size_t kTicketBytes = 16;    // of its id, random

access::LinkKey link_key(const http::Caller& caller) {
  return {.id = caller.owner, .sha256 = caller.key_sha256};
}

std::string linked_path(const std::string& id, const std::string& file) {
  return file == "job" ? api::job_path(id) : api::job_path(id) + "/" + file;
}

/// A URL that opens one resource of a job without an API key, for a time. Parameters: file (default
/// result) and seconds (1 to 604800; default 3600). Throws Error{invalid_option}.
http::Response get_link(const store::JobRecord& job, const access::LinkSigner& signer,
                        const http::Request& request) {
  std::string file(kLinked.front());
  std::int64_t seconds = kUsualSeconds;
  for (const auto& [name, text] : request.query) {
    http::check_once(request.query, name);
    if (name == "file") {
      file = text;
    } else if (name == "seconds") {
      seconds = http::positive_number(name, text, kMostSeconds);
    } else {
      http::refuse_unknown(name);
    }
  }
  if (std::ranges::count(kLinked, file) == 0)
    refuse_option("file", "A job has no such file; see /openapi.yaml.");
  const std::int64_t expires_ms = now_ms() + seconds * kMsPerSecond;
  const std::string url =
      signer.sign(linked_path(job.id, file), expires_ms / kMsPerSecond, link_key(request.caller));
  const api::Json link = {{"url", url}, {"expires", rfc3339(expires_ms)}};
  return http::uncached_json_response(200, link.dump());
}

struct TicketTerms {
  std::int64_t seconds = kUsualTicketSeconds;
  std::int64_t max_bytes;
  std::int64_t count = 1;
};

TicketTerms ticket_terms(const http::Request& request, std::int64_t most_bytes) {
  TicketTerms terms{.max_bytes = most_bytes};
  for (const auto& [name, text] : request.query) {
    http::check_once(request.query, name);
    if (name == "seconds") {
      terms.seconds = http::positive_number(name, text, kDay);
    } else if (name == "max_bytes") {
      terms.max_bytes = http::positive_number(name, text, most_bytes);
    } else if (name == "count") {
      terms.count = http::positive_number(name, text, kMostTickets);
    } else {
      http::refuse_unknown(name);
    }
  }
  return terms;
}

/// URLs to each of which somebody without an API key may post one job, for a time. Parameters:
/// seconds (1 to 86400; default 900), max_bytes (default: as large as requests may be) and count
/// (1 to 100). Throws Error{invalid_option}.
http::Response post_tickets(const JobServices& services, const http::Request& request) {
  const TicketTerms terms =
      ticket_terms(request, static_cast<std::int64_t>(services.limits.max_body_bytes));
  const std::int64_t expires_ms = now_ms() + terms.seconds * kMsPerSecond;
  api::Json urls = api::Json::array();
  for (std::int64_t k = 0; k < terms.count; ++k)
    urls.push_back(services.links.sign({.id = random_hex(kTicketBytes),
                                        .max_bytes = terms.max_bytes,
                                        .expires = expires_ms / kMsPerSecond},
                                       link_key(request.caller)));
  const api::Json tickets = {
      {"urls", urls}, {"expires", rfc3339(expires_ms)}, {"max_bytes", terms.max_bytes}};
  return http::uncached_json_response(200, tickets.dump());
}

}  // namespace

api::Json signed_links(const access::LinkSigner& signer, const std::string& id,
                       const http::Caller& caller) {
  const std::int64_t expires = now_ms() / kMsPerSecond + kDay;
  api::Json links = api::job_links(id);
  for (auto& link : links) link = signer.sign(link.get<std::string>(), expires, link_key(caller));
  return links;
}

void add_link_routes(std::vector<http::Route>& routes, const JobServices& services) {
  routes.push_back({"GET", "/v1/jobs/{id}/link", [services](const http::Request& request) {
                      return get_link(find_job(services.store, request), services.links, request);
                    }});
  routes.push_back({"POST", "/v1/tickets", [services](const http::Request& request) {
                      return post_tickets(services, request);
                    }});
}

}  // namespace unwrapd::server::routes
