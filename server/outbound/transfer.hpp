#pragma once
// One exchange with another server by libcurl (ADR 0042). It connects to an address that was
// checked, whatever libcurl makes of the host, uses no proxy, follows no redirect, speaks HTTP/1.1
// and TLS 1.2 or 1.3, trusts what OpenSSL trusts, and bounds the heads of the answer.

#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "server/outbound/curl_library.hpp"
#include "server/outbound/outbound_url.hpp"

namespace unwrapd::server::outbound {

/// While it lives, its thread gets no SIGPIPE: OpenSSL writes to connections that are closed, and
/// libcurl leaves signals to us.
class NoSigpipe {
 public:
  NoSigpipe();
  NoSigpipe(const NoSigpipe&) = delete;
  NoSigpipe& operator=(const NoSigpipe&) = delete;
  ~NoSigpipe();

 private:
  sigset_t before_{};
};

/// For use by the thread that made it.
class Transfer {
 public:
  /// A line of a head, with its line feed; field lines of earlier heads (100, 103) come, too.
  using TakeLine = std::function<void(std::string_view line)>;
  /// Called at the end of the final head. False ends the exchange before the body.
  using TakeHead = std::function<bool()>;
  /// False ends the exchange. It must not throw.
  using TakeBody = std::function<bool(std::string_view bytes)>;

  /// address: of its host, in numbers: no other is connected to. Throws Error{internal} when
  /// libcurl cannot be used.
  Transfer(const OutboundUrl& url, const std::string& address, std::chrono::milliseconds whole);
  Transfer(const Transfer&) = delete;
  Transfer& operator=(const Transfer&) = delete;
  ~Transfer();

  void add_header(const std::string& line);
  /// body: sent as it is; must outlive this.
  void set_post(const std::string& body);
  void on_line(TakeLine take) { take_line_ = std::move(take); }
  void on_head(TakeHead take) { take_head_ = std::move(take); }
  void on_body(TakeBody take) { take_body_ = std::move(take); }

  /// must_end: asked a few times a second. Call once.
  CURLcode run(const std::stop_token& stop, const std::function<bool()>& must_end = {});

  [[nodiscard]] bool has_answer() const { return has_final_head_; }
  [[nodiscard]] long status() const;
  /// Seconds of Retry-After; 0 without it.
  [[nodiscard]] std::chrono::seconds retry_after() const;
  /// Of the body, as the head tells it; -1 where it does not.
  [[nodiscard]] std::int64_t declared_bytes() const;
  [[nodiscard]] const char* words(CURLcode result) const { return curl_.easy_strerror(result); }

 private:
  /// An option that is not taken might be one that protects.
  template <class Value>
  void set(CURLoption option, Value value) {
    if (curl_.easy_setopt(easy_, option, value) != CURLE_OK)
      throw Error(ErrorCode::internal, "libcurl does not know an option of outbound calls.");
  }
  Transfer() = default;
  void append(curl_slist*& list, const std::string& text);
  void set_place(const OutboundUrl& url, const std::string& address);
  void set_limits(std::chrono::milliseconds whole);
  [[nodiscard]] bool take_line(std::string_view line);
  CURLcode perform(const std::stop_token& stop, const std::function<bool()>& must_end);
  static std::size_t line_came(const char* bytes, std::size_t one, std::size_t count, void* self);
  static std::size_t body_came(const char* bytes, std::size_t one, std::size_t count, void* self);

  const NoSigpipe quiet_;  // until the connection is closed
  const CurlLibrary& curl_ = CurlLibrary::loaded();
  CURL* easy_ = curl_.easy_init();
  CURLM* multi_ = curl_.multi_init();
  curl_slist* headers_ = nullptr;
  curl_slist* connect_to_ = nullptr;
  TakeLine take_line_;
  TakeHead take_head_;
  TakeBody take_body_;
  std::size_t head_bytes_ = 0;
  bool has_final_head_ = false;  // before it come 100 and 103
};

/// The address that a Location names, seen from the URL that answered with it; empty where it is
/// none. Its fragment is left out.
std::string resolve_location(const OutboundUrl& from, const std::string& location);

}  // namespace unwrapd::server::outbound
