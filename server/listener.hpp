#pragma once
// A listening TCP socket, and the descriptor by which everything that waits learns of the end.

#include <string>

namespace unwrapd::server {

class Listener {
 public:
  /// host: a name or address; port 0 takes a free one. Throws Error{internal} saying why not.
  Listener(const std::string& host, int port);
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener();

  [[nodiscard]] int port() const;
  [[nodiscard]] int socket() const { return socket_; }
  /// Readable once stop() was called.
  [[nodiscard]] int stop_descriptor() const { return stop_; }

  /// The next client's socket; -1 after stop().
  [[nodiscard]] int accept() const;
  /// Async-signal-safe.
  void stop() const;

 private:
  int socket_ = -1;
  int stop_ = -1;
};

}  // namespace unwrapd::server
