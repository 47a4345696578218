#include "server/listener.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <memory>
#include <system_error>
#include <thread>

#include "core/error.hpp"

namespace unwrapd::server {
namespace {

constexpr int kBacklog = 1024;
constexpr std::chrono::milliseconds kOutOfDescriptors{50};  // pause before the next accept

struct FreeAddresses {
  void operator()(addrinfo* list) const { ::freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

[[noreturn]] void fail(const std::string& host, int port, const std::string& reason) {
  throw Error(ErrorCode::internal, "Cannot listen on " + host + ":" + std::to_string(port) + " (" +
                                       reason + "); choose another --listen.");
}

Addresses resolve(const std::string& host, int port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int result = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &list);
  if (result != 0) fail(host, port, ::gai_strerror(result));
  return Addresses(list);
}

void set(int socket, int level, int option) {
  const int on = 1;
  ::setsockopt(socket, level, option, &on, sizeof on);
}

/// A socket that listens on this address, -1 when that fails.
int listen_on(const addrinfo& address) {
  const int socket = ::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK,
                              address.ai_protocol);
  if (socket < 0) return -1;
  set(socket, SOL_SOCKET, SO_REUSEADDR);
  if (::bind(socket, address.ai_addr, address.ai_addrlen) == 0 && ::listen(socket, kBacklog) == 0)
    return socket;
  const int reason = errno;
  ::close(socket);
  errno = reason;
  return -1;
}

}  // namespace

Listener::Listener(const std::string& host, int port) {
  const Addresses addresses = resolve(host, port);
  for (const addrinfo* at = addresses.get(); at != nullptr && socket_ < 0; at = at->ai_next)
    socket_ = listen_on(*at);
  if (socket_ < 0) fail(host, port, std::generic_category().message(errno));
  stop_ = ::eventfd(0, EFD_CLOEXEC);
}

Listener::~Listener() {
  ::close(socket_);
  ::close(stop_);
}

int Listener::port() const {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
  const auto* v4 = reinterpret_cast<const sockaddr_in*>(&address);
  const auto* v6 = reinterpret_cast<const sockaddr_in6*>(&address);
  return ntohs(address.ss_family == AF_INET6 ? v6->sin6_port : v4->sin_port);
}

int Listener::accept() const {
  std::array<pollfd, 2> polled = {pollfd{socket_, POLLIN, 0}, pollfd{stop_, POLLIN, 0}};
  while (true) {
    ::poll(polled.data(), polled.size(), -1);
    if (polled[1].revents != 0) return -1;
    const int client = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client >= 0) {
      set(client, IPPROTO_TCP, TCP_NODELAY);
      return client;
    }
    if (errno == EMFILE || errno == ENFILE) std::this_thread::sleep_for(kOutOfDescriptors);
  }
}

void Listener::stop() const {
  ::shutdown(socket_, SHUT_RDWR);  // who connects from now on is refused, not left waiting
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(stop_, &one, sizeof one);
}

}  // namespace unwrapd::server
