#include "client/servers.hpp"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <optional>
#include <utility>

namespace unwrapd::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kLeftOut{5};

}  // namespace

struct Servers::Known {
  struct Address {
    ServerUrl url;
    Clock::time_point silent_until = {};
  };

  Address& of(const ServerUrl& url) {
    return *std::ranges::find_if(addresses, [&](const Address& each) {
      return each.url.origin == url.origin && each.url.prefix == url.prefix;
    });
  }

  std::vector<Address> addresses;
  std::mutex mutex;
  std::size_t turn = 0;
  std::optional<Clock::time_point> last_answer;
};

Servers::Servers(ServerUrl only) : Servers(std::vector<ServerUrl>{std::move(only)}) {}

Servers::Servers(std::vector<ServerUrl> all) : known_(std::make_shared<Known>()) {
  for (ServerUrl& url : all) known_->addresses.push_back({std::move(url)});
}

const ServerUrl& Servers::next() {
  const std::scoped_lock lock(known_->mutex);
  const auto& all = known_->addresses;
  const Clock::time_point now = Clock::now();
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto& address = all[known_->turn++ % all.size()];
    if (address.silent_until <= now) return address.url;
  }
  return all[known_->turn++ % all.size()].url;
}

void Servers::note_answer(const ServerUrl& server) {
  const std::scoped_lock lock(known_->mutex);
  known_->last_answer = Clock::now();
  known_->of(server).silent_until = {};
}

void Servers::note_silence(const ServerUrl& server) {
  const std::scoped_lock lock(known_->mutex);
  known_->of(server).silent_until = Clock::now() + kLeftOut;
}

std::size_t Servers::size() const { return known_->addresses.size(); }

bool Servers::have_answered(Clock::time_point since) const {
  const std::scoped_lock lock(known_->mutex);
  return known_->last_answer && *known_->last_answer >= since;
}

}  // namespace unwrapd::client
