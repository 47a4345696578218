#include "server/sources/sources.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "api/error_table.hpp"
#include "core/base/error.hpp"
#include "server/base/errors.hpp"
#include "server/http/sites.hpp"
#include "server/outbound/transfer.hpp"
#include "server/sources/source_exchange.hpp"

namespace unwrapd::server::sources {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kMaxRedirects = 5;
constexpr int kBusyRetrySeconds = 5;
constexpr outbound::UrlUse kSource{
    .refused = ErrorCode::source_refused, .whose = "source", .where = kSourcePointer};

Error refusal(const std::string& what) { return {ErrorCode::source_refused, what, kSourcePointer}; }

/// The same words for a host that is not named and for one at a private address: they tell nothing
/// of the operator's network.
Error not_allowed(const std::string& host) {
  return refusal("This server may not read meshes from " + host +
                 "; send the bytes, or ask its operator to allow the host (--source-hosts).");
}

/// Another host of a redirect is not told: only the one that was asked for is known to the client.
Error redirect_not_allowed() {
  return refusal(
      "The source redirects to an address that this server may not read; send the bytes, or ask "
      "its operator to allow that host (--source-hosts), too.");
}

}  // namespace

/// A file that is read from its address, and told of in the log and the metrics.
class Sources::Download : public http::BodyReader {
 public:
  Download(const Sources& sources, outbound::OutboundUrl url, SourceUse use,
           ConcurrencyLimit::Place place)
      : sources_(sources), url_(std::move(url)), use_(std::move(use)), place_(std::move(place)) {}

  void read(const Sink& sink) override {
    try {
      read_chain(sink);
      tell("read");
    } catch (const Error& error) {
      tell(api::error_row(error.code()).name);
      throw;
    }
  }
  void read_parts(const PartStart&, const Sink&) override {
    throw std::logic_error("a source has no parts");
  }

 private:
  void read_chain(const Sink& sink);
  [[nodiscard]] std::string get(const outbound::OutboundUrl& url,
                                const std::vector<std::string>& addresses, const Sink& sink);
  [[nodiscard]] ExchangeLimits limits() const;
  void check_wanted() const;
  void tell(std::string_view outcome) const;

  const Sources& sources_;
  const outbound::OutboundUrl url_;
  const SourceUse use_;
  const ConcurrencyLimit::Place place_;
  const Clock::time_point begin_ = Clock::now();
  std::int64_t bytes_ = 0;
};

void Sources::Download::check_wanted() const {
  if (use_.draining && use_.draining()) throw draining();
  if (use_.has_left && use_.has_left()) throw source_failure("The client has left.");
}

ExchangeLimits Sources::Download::limits() const {
  const auto end = begin_ + std::chrono::seconds(sources_.config_.seconds);
  return {.max_bytes = sources_.max_bytes_,
          .time_left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()),
          .seconds = sources_.config_.seconds,
          .must_end = [this] {
            return (use_.draining && use_.draining()) || (use_.has_left && use_.has_left());
          }};
}

/// Tries the addresses of the host in turn until one takes the connection.
std::string Sources::Download::get(const outbound::OutboundUrl& url,
                                   const std::vector<std::string>& addresses, const Sink& sink) {
  for (std::size_t i = 0;; ++i) {
    const ExchangeLimits limits = this->limits();
    SourceExchange exchange(url, addresses[i], limits, sink);
    try {
      std::string location = exchange.run();
      bytes_ += exchange.bytes();
      return location;
    } catch (const Error&) {
      bytes_ += exchange.bytes();
      check_wanted();
      const bool is_last = i + 1 == addresses.size() || limits.time_left <= limits.time_left.zero();
      if (is_last || !exchange.is_unreachable()) throw;
    }
  }
}

void Sources::Download::read_chain(const Sink& sink) {
  outbound::OutboundUrl url = url_;
  for (int redirects = 0; redirects <= kMaxRedirects; ++redirects) {
    const std::string location = get(url, sources_.resolve(url, redirects > 0), sink);
    if (location.empty() && bytes_ == 0)
      throw source_failure("The source is empty; name a GLB, glTF or OBJ file.");
    if (location.empty()) return;
    url = sources_.follow(url, location);
  }
  throw source_failure("The source redirects more than " + std::to_string(kMaxRedirects) +
                       " times; give its last address.");
}

/// Neither path nor query, which may hold a token.
void Sources::Download::tell(std::string_view outcome) const {
  sources_.metrics_.count(Metric::sources, {{"outcome", outcome}});
  sources_.metrics_.count(Metric::source_bytes, {}, static_cast<double>(bytes_));
  const std::chrono::duration<double> took = Clock::now() - begin_;
  sources_.log_.info(
      "source asked for",
      {{"host", url_.host}, {"outcome", outcome}, {"bytes", bytes_}, {"seconds", took.count()}});
}

Sources::Sources(const SourceConfig& config, std::int64_t max_bytes, const Log& log,
                 Metrics& metrics)
    : config_(config),
      max_bytes_(max_bytes),
      log_(log),
      metrics_(metrics),
      downloads_(config.at_once, half_of_the_rest) {
  if (!config_.allowed_hosts.empty())
    outbound::CurlLibrary::loaded();  // missing: told at the start
}

outbound::OutboundUrl Sources::parse(const std::string& address) const {
  if (config_.allowed_hosts.empty())
    throw refusal(
        "This server reads no meshes from addresses; send the bytes, or ask its operator to allow "
        "the host (--source-hosts).");
  outbound::OutboundUrl url = outbound::read_url(address, kSource);
  if (!url.is_https && !config_.allow_http)
    throw refusal("The source's address must begin with https://; correct it.");
  const bool is_private = outbound::is_address(url.host) && !outbound::is_public_address(url.host);
  if (!http::is_named(url.host, config_.allowed_hosts) || (is_private && !config_.allow_private))
    throw not_allowed(url.host);
  return url;
}

outbound::OutboundUrl Sources::follow(const outbound::OutboundUrl& from,
                                      const std::string& location) const {
  try {
    return parse(outbound::resolve_location(from, location));
  } catch (const Error&) {
    throw redirect_not_allowed();
  }
}

std::vector<std::string> Sources::resolve(const outbound::OutboundUrl& url,
                                          bool is_redirect) const {
  std::vector<std::string> addresses = outbound::addresses_of(url.host);
  if (addresses.empty())
    throw source_failure("The source's host cannot be found; check the address.");
  if (!config_.allow_private && !std::ranges::all_of(addresses, outbound::is_public_address))
    throw is_redirect ? redirect_not_allowed() : not_allowed(url.host);
  return addresses;
}

std::unique_ptr<http::BodyReader> Sources::open(const std::string& address, SourceUse use) {
  outbound::OutboundUrl url = parse(address);
  ConcurrencyLimit::Place place = downloads_.try_enter(use.owner);
  if (!place)
    throw RetryLater(ErrorCode::rate_limited,
                     "Too many sources are being read; send the request again after Retry-After, "
                     "or send the bytes.",
                     kBusyRetrySeconds);
  return std::make_unique<Download>(*this, std::move(url), std::move(use), std::move(place));
}

}  // namespace unwrapd::server::sources
