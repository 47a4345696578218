#pragma once
// The addresses of one service, in use by several threads.

#include <chrono>
#include <cstddef>
#include <memory>
#include <vector>

#include "client/server_url.hpp"

namespace unwrapd::client {

/// Any address will do for any call, whoever answered the one before. Copies share what is known of
/// the addresses.
class Servers {
 public:
  Servers(ServerUrl only);  // NOLINT(google-explicit-constructor): one address is a list of one
  /// Requires at least one.
  explicit Servers(std::vector<ServerUrl> all);

  /// The next address in turn, but for those that gave no answer in the last seconds; if none
  /// did, of all.
  [[nodiscard]] const ServerUrl& next();

  void note_answer(const ServerUrl& server);
  void note_silence(const ServerUrl& server);

  [[nodiscard]] std::size_t size() const;
  /// Whether any address has ever answered, or since then.
  [[nodiscard]] bool have_answered(std::chrono::steady_clock::time_point since = {}) const;

 private:
  struct Known;
  std::shared_ptr<Known> known_;
};

}  // namespace unwrapd::client
