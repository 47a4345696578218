#include "server/parking.hpp"

#include <poll.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "server/http_head.hpp"

namespace unwrapd::server {
namespace {

constexpr int kTickMs = 100;  // how late a deadline may be noticed
constexpr int kMostEvents = 256;
constexpr int kAcceptsInARow = 64;
constexpr std::size_t kReadBytes = std::size_t{4} * 1024;
constexpr std::string_view kHeadEnd = "\r\n\r\n";

}  // namespace

Parking::Parking(const Listener& listener, Uses uses, const ParkingRules& rules)
    : listener_(listener),
      uses_(std::move(uses)),
      rules_(rules),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

Parking::~Parking() {
  ::close(wake_);
  ::close(epoll_);
}

/// poll()'s and epoll's events are the same bits.
void Parking::watch(int descriptor, short events, int operation) const {
  epoll_event event{};
  event.events = static_cast<std::uint32_t>(events);
  event.data.fd = descriptor;
  ::epoll_ctl(epoll_, operation, descriptor, &event);
}

void Parking::run() {
  for (const int descriptor : {listener_.socket(), listener_.stop_descriptor(), wake_})
    watch(descriptor, POLLIN, EPOLL_CTL_ADD);
  std::array<epoll_event, kMostEvents> events;
  while (!stopped_) {
    const int count = ::epoll_wait(epoll_, events.data(), kMostEvents, lot_.empty() ? -1 : kTickMs);
    for (int i = 0; i < count; ++i) attend(events[static_cast<std::size_t>(i)].data.fd);
    expire();
  }
  lot_.clear();
  count_ = 0;
}

void Parking::attend(int descriptor) {
  if (descriptor == listener_.stop_descriptor()) stopped_ = true;
  if (descriptor == listener_.socket()) let_in();
  if (descriptor == wake_) take_back();
  const auto at = lot_.find(descriptor);
  if (at != lot_.end()) look_at(at);
}

void Parking::let_in() {
  for (int i = 0; i < kAcceptsInARow; ++i) {
    std::optional<Client> client = uses_.accept();
    if (!client) return;
    if (client->transport) admit(std::move(*client));
  }
}

void Parking::park(Client client) {
  {
    const std::lock_guard lock(mutex_);
    returned_.push_back(std::move(client));
  }
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(wake_, &one, sizeof one);
}

void Parking::take_back() {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = ::read(wake_, &count, sizeof count);
  std::vector<Client> returned;
  {
    const std::lock_guard lock(mutex_);
    returned.swap(returned_);
  }
  for (Client& client : returned) admit(std::move(client));
}

void Parking::admit(Client client) {
  const int socket = client.transport->socket();
  const bool began = !client.received.empty();
  const bool complete = client.received.find(kHeadEnd) != std::string::npos;
  const auto until = Clock::now() + (began ? rules_.head : rules_.idle);
  const auto at =
      lot_.insert_or_assign(socket, Parked{std::move(client), until, POLLIN, complete}).first;
  count_ = static_cast<int>(lot_.size());
  watch(socket, POLLIN, EPOLL_CTL_ADD);
  look_at(at);  // TLS may hold bytes that the socket no longer tells of
  if (count_ > rules_.max_idle) drive_out_longest_idle();
}

/// Reads what is there. False when the client has left.
bool Parking::receive(Parked& parked) {
  std::string& received = parked.client.received;
  std::array<char, kReadBytes> piece;
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

void Parking::look_at(Lot::iterator at) {
  Parked& parked = at->second;
  if (!receive(parked)) {
    remove(at);
    return;
  }
  if (parked.complete || parked.client.received.size() > kMaxHeadBytes)
    return uses_.ready(remove(at));
  const short awaits = parked.client.transport->awaits(POLLIN);
  if (awaits != parked.awaits) watch(at->first, awaits, EPOLL_CTL_MOD);
  parked.awaits = awaits;
}

Client Parking::remove(Lot::iterator at) {
  Client client = std::move(at->second.client);
  ::epoll_ctl(epoll_, EPOLL_CTL_DEL, at->first, nullptr);
  lot_.erase(at);
  count_ = static_cast<int>(lot_.size());
  return client;
}

void Parking::drive_out_longest_idle() {
  auto longest = lot_.end();
  int idle = 0;
  for (auto at = lot_.begin(); at != lot_.end(); ++at) {
    if (!at->second.client.received.empty()) continue;
    ++idle;
    if (longest == lot_.end() || at->second.until < longest->second.until) longest = at;
  }
  if (idle > rules_.max_idle) remove(longest);
}

void Parking::close_late(Lot::iterator at) {
  Client late = remove(at);
  if (late.received.empty()) return;
  uses_.refuse(late, Error(ErrorCode::request_timeout,
                           "The header did not arrive in time; send it faster."));
}

void Parking::expire() {
  const auto now = Clock::now();
  for (auto at = lot_.begin(); at != lot_.end();) {
    const auto next = std::next(at);
    if (at->second.until <= now) close_late(at);
    at = next;
  }
}

}  // namespace unwrapd::server
