#include "server/http/listener.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
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

#include "core/base/error.hpp"
#include "server/http/addresses.hpp"

namespace unwrapd::server::http {
namespace {

constexpr int kBacklog = 1024;
constexpr std::chrono::milliseconds kOutOfDescriptors{50};  // pause before the next accept

struct FreeAddresses {
  void operator()(addrinfo* list) const { ::freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

/// The wanted address, and the option that sets it.
struct Wanted {
  std::string host;
  int port = 0;
  std::string_view option;
};

[[noreturn]] void fail(const Wanted& wanted, const std::string& reason) {
  throw Error(ErrorCode::internal, "Cannot listen on " + to_text({wanted.host, wanted.port}) +
                                       " (" + reason + "); choose another " +
                                       std::string(wanted.option) + ".");
}

Addresses resolve(const Wanted& wanted) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int result =
      ::getaddrinfo(wanted.host.c_str(), std::to_string(wanted.port).c_str(), &hints, &list);
  if (result != 0) fail(wanted, ::gai_strerror(result));
  return Addresses(list);
}

void set(int socket, int level, int option) {
  const int on = 1;
  ::setsockopt(socket, level, option, &on, sizeof on);
}

/// Returns an IPv4 address that is mapped into IPv6 as IPv4.
std::string numeric_host(const sockaddr_storage& address, socklen_t size) {
  std::array<char, NI_MAXHOST> host{};
  const int failed = ::getnameinfo(reinterpret_cast<const sockaddr*>(&address), size, host.data(),
                                   host.size(), nullptr, 0, NI_NUMERICHOST);
  if (failed != 0) return {};
  constexpr std::string_view mapped = "::ffff:";
  const std::string_view text(host.data());
  return std::string(text.starts_with(mapped) ? text.substr(mapped.size()) : text);
}

/// A socket that listens on this address; -1 on failure.
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

/// A descriptor for Listener::shut_out(); -1 when there is none.
int open_spare() { return ::open("/dev/null", O_RDONLY | O_CLOEXEC); }

}  // namespace

Listener::Listener(const std::string& host, int port, std::string_view option) {
  const Wanted wanted{.host = host, .port = port, .option = option};
  const Addresses addresses = resolve(wanted);
  for (const addrinfo* at = addresses.get(); at != nullptr && socket_ < 0; at = at->ai_next)
    socket_ = listen_on(*at);
  if (socket_ < 0) fail(wanted, std::generic_category().message(errno));
  stop_ = ::eventfd(0, EFD_CLOEXEC);
  spare_ = open_spare();
}

Listener::~Listener() {
  ::close(socket_);
  ::close(stop_);
  if (spare_ >= 0) ::close(spare_);
}

int Listener::port() const {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
  const auto* v4 = reinterpret_cast<const sockaddr_in*>(&address);
  const auto* v6 = reinterpret_cast<const sockaddr_in6*>(&address);
  return ntohs(address.ss_family == AF_INET6 ? v6->sin6_port : v4->sin_port);
}

std::optional<Accepted> Listener::accept() const {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  const int client = ::accept4(socket_, reinterpret_cast<sockaddr*>(&address), &size,
                               SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (client < 0) {
    if (errno == EMFILE || errno == ENFILE) shut_out();
    return std::nullopt;
  }
  set(client, IPPROTO_TCP, TCP_NODELAY);
  return Accepted{.socket = client, .address = numeric_host(address, size)};
}

void Listener::shut_out() const {
  if (spare_ < 0) return std::this_thread::sleep_for(kOutOfDescriptors);
  ::close(spare_);
  const int client = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (client >= 0) ::close(client);
  spare_ = open_spare();
}

void Listener::stop() const {
  ::shutdown(socket_,
             SHUT_RDWR);  // later clients are refused rather than left waiting
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(stop_, &one, sizeof one);
}

}  // namespace unwrapd::server::http
