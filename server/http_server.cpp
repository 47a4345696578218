#include "server/http_server.hpp"

#include <exception>
#include <utility>

#include "server/http_exchange.hpp"

namespace unwrapd::server {
namespace {

/// A refusal before httplib has seen the request.
std::string plain_refusal(const Error& error) {
  const Response response = error_response(error);
  const auto& body = std::get<std::string>(response.body);
  return "HTTP/1.1 " + std::to_string(response.status) +
         " Refused\r\nContent-Type: " + response.content_type +
         "\r\nContent-Length: " + std::to_string(body.size()) + "\r\nConnection: close\r\n\r\n" +
         body;
}

void write_all(Connection& connection, std::string_view bytes) {
  while (!bytes.empty()) {
    const std::int64_t sent = connection.write(bytes);
    if (sent < 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

}  // namespace

HttpServer::HttpServer(const HttpConfig& config, Handler answer, const Log& log)
    : config_(config), answer_(std::move(answer)), log_(log), listener_(config.host, config.port) {}

void HttpServer::serve() {
  std::vector<std::jthread> threads;
  threads.reserve(static_cast<std::size_t>(config_.max_connections));
  for (int i = 0; i < config_.max_connections; ++i) threads.emplace_back([this] { work(); });
  while (true) {
    const int client = listener_.accept();
    const std::lock_guard lock(mutex_);
    stopping_ = client < 0;
    if (stopping_) break;
    clients_.push_back(client);
    waiting_ = clients_.size();
    arrived_.notify_one();
  }
  arrived_.notify_all();
}

void HttpServer::work() {
  while (true) {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return stopping_ || !clients_.empty(); });
    if (clients_.empty()) return;
    const int client = clients_.front();
    clients_.pop_front();
    waiting_ = clients_.size();
    lock.unlock();
    serve_connection(client);
  }
}

void HttpServer::serve_connection(int client) {
  try {
    Connection connection(client, listener_.stop_descriptor(), config_.limits);
    serve_requests(connection);
  } catch (const std::exception& error) {
    log_.error("a connection failed", {{"reason", error.what()}});
  }
}

void HttpServer::serve_requests(Connection& connection) {
  Exchange exchange(connection, answer_, log_);
  try {
    while (connection.next_request()) {
      const bool last = stopping_ || waiting_ > 0;  // do not keep a thread that others wait for
      if (!exchange.answer_request(last)) return;
    }
  } catch (const Error& error) {
    write_all(connection, plain_refusal(error));
  }
}

void HttpServer::stop() { listener_.stop(); }

}  // namespace unwrapd::server
