#pragma once
// One GET of a source from one address of its host.

#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "server/http/http.hpp"
#include "server/outbound/outbound_url.hpp"
#include "server/outbound/transfer.hpp"

namespace unwrapd::server::sources {

inline constexpr const char* kSourcePointer = "/source";

/// Error{source_failed} with its pointer.
Error source_failure(const std::string& what);

struct ExchangeLimits {
  std::int64_t max_bytes = 0;
  std::chrono::milliseconds time_left{0};
  int seconds = 0;                      ///< in all, for the words of a refusal
  std::function<bool()> must_end = {};  ///< asked a few times a second
};

class SourceExchange {
 public:
  SourceExchange(const outbound::OutboundUrl& url, const std::string& address,
                 const ExchangeLimits& limits, const http::BodyReader::Sink& sink);

  /// The Location of a redirect; empty when the whole file has gone to the sink. Throws Error:
  /// source_failed, body_too_large, unsupported_media_type, and what the sink throws. Call once.
  std::string run();
  /// Whether nothing came because the address took no connection.
  [[nodiscard]] bool is_unreachable() const { return is_unreachable_; }
  [[nodiscard]] std::int64_t bytes() const { return bytes_; }

 private:
  void take_line(std::string_view line);
  [[nodiscard]] bool take_head();
  [[nodiscard]] bool take_body(std::string_view bytes);
  void check_head() const;
  void check_size(std::int64_t bytes) const;
  /// Runs a step whose exception ends the exchange; false then.
  template <class Step>
  bool goes_on(const Step& step);
  [[nodiscard]] Error failure(CURLcode result) const;

  const outbound::OutboundUrl& url_;
  const ExchangeLimits& limits_;
  const http::BodyReader::Sink& sink_;
  outbound::Transfer transfer_;
  std::string type_;
  std::string coding_;
  std::string location_;
  std::exception_ptr thrown_;
  std::int64_t bytes_ = 0;
  bool is_redirect_ = false;
  bool is_unreachable_ = false;
};

}  // namespace unwrapd::server::sources
