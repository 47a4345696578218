#pragma once
// The bytes of one client, plain or inside TLS. No call waits: after kAgain, the caller waits for
// awaits() and calls again.

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace unwrapd::server::http {

class Transport {
 public:
  static constexpr std::int64_t kAgain = -1;
  static constexpr std::int64_t kBroken = -2;

  /// Owns socket, which must not block.
  explicit Transport(int socket) : socket_(socket) {}
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport();

  /// The number of bytes, 0 at the end, kAgain or kBroken.
  virtual std::int64_t receive(char* data, std::size_t size);
  virtual std::int64_t send(std::string_view bytes);
  /// Whether bytes of requests can come; else handshake() is to be called when awaits(POLLIN) is
  /// ready.
  [[nodiscard]] virtual bool is_open() const { return true; }
  /// Does a step of the handshake without waiting. False when the handshake has failed.
  virtual bool handshake() { return true; }
  /// The event to poll() for after kAgain: POLLIN or POLLOUT.
  [[nodiscard]] virtual short awaits(short wanted) const { return wanted; }
  /// Ends sending: the client reads an end of file.
  virtual void end();

  [[nodiscard]] int socket() const { return socket_; }

 private:
  const int socket_;
};

/// A client on its way through the server.
struct Client {
  std::unique_ptr<Transport> transport;
  std::string address = {};          ///< numeric, without the port
  std::string received = {};         ///< and not yet used
  std::shared_ptr<void> place = {};  ///< among the connections that may be open
  /// When the first byte of a request must be there, set from the first step of a handshake on.
  std::optional<std::chrono::steady_clock::time_point> until = {};
};

}  // namespace unwrapd::server::http
