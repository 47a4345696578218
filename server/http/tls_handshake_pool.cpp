#include "server/http/tls_handshake_pool.hpp"

#include <utility>

namespace unwrapd::server::http {

TlsHandshakePool::TlsHandshakePool(int threads, std::function<void(Client)> back)
    : back_(std::move(back)) {
  threads_.reserve(static_cast<std::size_t>(threads));
  for (int i = 0; i < threads; ++i)
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
}

void TlsHandshakePool::handshake(Client client) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(client));
  }
  arrived_.notify_one();
}

void TlsHandshakePool::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (arrived_.wait(lock, stop, [&] { return !waiting_.empty(); }) && !stop.stop_requested()) {
    Client client = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    if (client.transport->handshake()) back_(std::move(client));
    lock.lock();
  }
}

}  // namespace unwrapd::server::http
