#include "server/http/transport.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

namespace unwrapd::server::http {
namespace {

std::int64_t result_of(ssize_t count) {
  if (count >= 0) return count;
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? Transport::kAgain
                                                                   : Transport::kBroken;
}

}  // namespace

Transport::~Transport() { ::close(socket_); }

std::int64_t Transport::receive(char* data, std::size_t size) {
  return result_of(::recv(socket_, data, size, MSG_DONTWAIT));
}

std::int64_t Transport::send(std::string_view bytes) {
  return result_of(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
}

void Transport::end() { ::shutdown(socket_, SHUT_WR); }

}  // namespace unwrapd::server::http
