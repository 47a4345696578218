#pragma once
// A limit on how much happens at once: requests that wait for a job (each holds a thread), event
// streams, open connections, files that are made, calls to webhooks. Each use has one object of
// this class. A rule tells how many places one owner (an API key, a network, a receiver) may hold,
// so that a few owners cannot take them all.

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace unwrapd::server {

/// Thread-safe. A place may outlive it.
class ConcurrencyLimit {
 public:
  /// Held until the last copy is destroyed or reset.
  using Place = std::shared_ptr<void>;
  /// How many places one owner may hold. places: in all; others: held by all other owners.
  using Share = std::function<int(int places, int others)>;
  enum class Refusal { none, full, share };

  /// An owner without a name is not held to a share: it stands for callers that cannot be told
  /// apart.
  ConcurrencyLimit(int places, Share share);

  /// A place, or nullptr and the reason: `full` when all are taken, `share` when this owner holds
  /// its share. Never waits.
  [[nodiscard]] Place try_enter(const std::string& owner, Refusal* why = nullptr);
  /// The reason for which try_enter() would return nullptr now.
  [[nodiscard]] Refusal refusal(const std::string& owner) const;

  /// Places taken, in all or by this owner.
  [[nodiscard]] int count() const;
  [[nodiscard]] int count(const std::string& owner) const;

 private:
  struct State;

  const std::shared_ptr<State> state_;
};

/// Half of the places that the other owners leave free, rounded up: however few owners there are,
/// a new one finds a place.
int half_of_the_rest(int places, int others);
/// Half of all places, at least one.
int half_of_all(int places, int others);
/// Three quarters of all places, rounded up.
int three_quarters(int places, int others);

}  // namespace unwrapd::server
