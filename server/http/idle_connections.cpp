#include "server/http/idle_connections.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <utility>

#include "server/http/http_head.hpp"

namespace unwrapd::server::http {
namespace {

constexpr int kTickMs = 100;  // how late a deadline may be noticed; not sooner: it looks at all
constexpr int kAcceptsInARow = 64;
constexpr std::size_t kPieceBytes = std::size_t{4} * 1024;
constexpr std::string_view kHeadEnd = "\r\n\r\n";

}  // namespace

IdleConnections::IdleConnections(const Listener& listener, Uses uses, const IdleRules& rules)
    : listener_(listener), uses_(std::move(uses)), rules_(rules) {
  for (const int descriptor :
       {listener_.socket(), listener_.stop_descriptor(), wakeup_.descriptor()})
    epoll_.add(descriptor, POLLIN);
}

void IdleConnections::run() {
  while (!stopped_) {
    turn(lot_.empty() ? -1 : kTickMs);
    const auto now = Clock::now();
    if (now < next_expiry_) continue;
    next_expiry_ = now + std::chrono::milliseconds(kTickMs);
    expire(now);
  }
  lot_.clear();
  count_ = 0;
}

void IdleConnections::turn(int patience_ms) {
  for (const epoll_event& event : epoll_.wait(patience_ms)) attend(event.data.fd);
}

void IdleConnections::attend(int descriptor) {
  if (descriptor == listener_.stop_descriptor()) stopped_ = true;
  if (descriptor == listener_.socket()) let_in();
  if (descriptor == wakeup_.descriptor()) take_back();
  const auto at = lot_.find(descriptor);
  if (at == lot_.end()) return;
  if (at->second.client.transport->is_open()) return look_at(at);
  if (at->second.until <= Clock::now()) return close_late(at);  // it may never be here for expire()
  at->second.client.until = at->second.until;
  uses_.handshake(remove(at));
}

void IdleConnections::let_in() {
  for (int i = 0; i < kAcceptsInARow; ++i) {
    std::optional<Client> client = uses_.accept();
    if (!client) return;
    if (client->transport) admit(std::move(*client));
  }
}

void IdleConnections::park(Client client) {
  {
    const std::lock_guard lock(mutex_);
    returned_.push_back(std::move(client));
  }
  wakeup_.ring();
}

void IdleConnections::take_back() {
  wakeup_.answer();
  std::vector<Client> returned;
  {
    const std::lock_guard lock(mutex_);
    returned.swap(returned_);
  }
  for (Client& client : returned) admit(std::move(client));
}

void IdleConnections::admit(Client client) {
  const int socket = client.transport->socket();
  const bool began = !client.received.empty();
  const bool complete = client.received.find(kHeadEnd) != std::string::npos;
  const auto until = client.until.value_or(Clock::now() + (began ? rules_.head : rules_.idle));
  client.until.reset();
  const short awaits = client.transport->awaits(POLLIN);
  const bool is_open = client.transport->is_open();
  const auto at =
      lot_.insert_or_assign(socket, IdleConnection{std::move(client), until, awaits, complete})
          .first;
  count_ = static_cast<int>(lot_.size());
  epoll_.add(socket, awaits);
  if (is_open) look_at(at);  // TLS may hold bytes that the socket no longer tells of
  if (count_ > rules_.max_idle) drive_out_longest_idle();
  if (rules_.max_parked > 0 && count_ > rules_.max_parked) drive_out_next_late();
}

void IdleConnections::drive_out_next_late() {
  const auto until = [](const auto& entry) { return entry.second.until; };
  remove(std::ranges::min_element(lot_, {}, until));
}

/// Reads the bytes that are there. False when the client has left.
bool IdleConnections::receive(IdleConnection& parked) {
  std::string& received = parked.client.received;
  std::array<char, kPieceBytes> piece;
  while (received.size() <= kMaxHeadBytes && !parked.complete) {
    const std::int64_t got = parked.client.transport->receive(piece.data(), piece.size());
    if (got == Transport::kAgain) return true;
    if (got <= 0) return false;
    if (received.empty()) parked.until = Clock::now() + rules_.head;
    const std::size_t from = received.size() - std::min(received.size(), kHeadEnd.size() - 1);
    received.append(piece.data(), static_cast<std::size_t>(got));
    parked.complete = received.find(kHeadEnd, from) != std::string::npos;
  }
  return true;
}

void IdleConnections::look_at(Lot::iterator at) {
  IdleConnection& parked = at->second;
  if (!receive(parked)) {
    remove(at);
    return;
  }
  if (parked.complete || parked.client.received.size() > kMaxHeadBytes)
    return uses_.ready(remove(at));
  const short awaits = parked.client.transport->awaits(POLLIN);
  if (awaits != parked.awaits) epoll_.change(at->first, awaits);
  parked.awaits = awaits;
}

Client IdleConnections::remove(Lot::iterator at) {
  Client client = std::move(at->second.client);
  epoll_.remove(at->first);
  lot_.erase(at);
  count_ = static_cast<int>(lot_.size());
  return client;
}

void IdleConnections::drive_out_longest_idle() {
  auto longest = lot_.end();
  int idle = 0;
  for (auto at = lot_.begin(); at != lot_.end(); ++at) {
    if (!at->second.client.received.empty()) continue;
    ++idle;
    if (longest == lot_.end() || at->second.until < longest->second.until) longest = at;
  }
  if (idle > rules_.max_idle) remove(longest);
}

void IdleConnections::close_late(Lot::iterator at) {
  Client late = remove(at);
  if (late.received.empty()) return;
  uses_.refuse(late, Error(ErrorCode::request_timeout,
                           "The header did not arrive in time; send it faster."));
}

void IdleConnections::expire(Clock::time_point now) {
  for (auto at = lot_.begin(); at != lot_.end();) {
    const auto next = std::next(at);
    if (at->second.until <= now) close_late(at);
    at = next;
  }
}

}  // namespace unwrapd::server::http
