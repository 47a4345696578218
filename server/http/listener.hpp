#pragma once
// A listening TCP socket, and the descriptor by which everything that waits
// learns of the end.

#include <optional>
#include <string>
#include <string_view>

namespace unwrapd::server::http {

/// A client at the door.
struct Accepted {
  int socket = -1;      ///< does not block
  std::string address;  ///< numeric, without the port; empty when it has none
};

class Listener {
 public:
  /// host: a name or address; port 0 takes a free one. Throws Error{internal}
  /// saying why not, and which option is to be given another.
  Listener(const std::string& host, int port, std::string_view option = "--listen");
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener();

  [[nodiscard]] int port() const;
  [[nodiscard]] int socket() const { return socket_; }
  /// Readable once stop() was called.
  [[nodiscard]] int stop_descriptor() const { return stop_; }

  /// The next that waits at the door; nothing when there is none. Where no descriptor is left for
  /// it, it is closed. For one thread alone.
  [[nodiscard]] std::optional<Accepted> accept() const;
  /// Async-signal-safe.
  void stop() const;

 private:
  /// Takes the next client at the door and closes it, by the descriptor that is kept for that.
  void shut_out() const;

  int socket_ = -1;
  int stop_ = -1;
  mutable int spare_ = -1;  // open while others may be had
};

}  // namespace unwrapd::server::http
