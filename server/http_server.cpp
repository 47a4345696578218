#include "server/http_server.hpp"

#include <sys/socket.h>

#include <exception>
#include <thread>
#include <utility>
#include <vector>

#include "api/error_table.hpp"
#include "server/job_queue.hpp"

namespace unwrapd::server {
namespace {

constexpr int kRetrySeconds = 5;

/// A refusal before httplib has seen the request.
std::string plain_refusal(const Error& error) {
  const Response response = error_response(error);
  const auto& body = std::get<std::string>(response.body);
  std::string text = "HTTP/1.1 " + std::to_string(response.status) + " Refused\r\n";
  for (const auto& [name, value] : response.headers)
    text.append(name).append(": ").append(value).append("\r\n");
  return text + "Content-Type: " + response.content_type +
         "\r\nContent-Length: " + std::to_string(body.size()) + "\r\nConnection: close\r\n\r\n" +
         body;
}

std::int64_t write_all(Connection& connection, std::string_view bytes) {
  const std::size_t all = bytes.size();
  while (!bytes.empty()) {
    const std::int64_t sent = connection.write(bytes);
    if (sent < 0) break;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return static_cast<std::int64_t>(all - bytes.size());
}

RetryLater no_place(Places::Refusal why) {
  const std::string whose = why == Places::Refusal::full ? "" : " from this address";
  return {ErrorCode::rate_limited,
          "Too many connections are open" + whose + "; use fewer, or come back after Retry-After.",
          kRetrySeconds};
}

std::optional<TlsContext> tls_of(const HttpConfig& config) {
  if (config.tls_certificate.empty()) return std::nullopt;
  return std::optional<TlsContext>(std::in_place, config.tls_certificate, config.tls_key);
}

}  // namespace

HttpServer::HttpServer(const HttpConfig& config, HttpUses uses, const Log& log)
    : config_(config),
      uses_(std::move(uses)),
      log_(log),
      tls_(tls_of(config)),
      listener_(config.address.host, config.address.port),
      places_(config.max_connections, config.max_connections_per_address),
      parking_(listener_,
               {.accept = [this] { return let_in(); },
                .ready = [this](Client client) { make_ready(std::move(client)); },
                .refuse = [this](Client& client, const Error& why) { turn_away(client, why); }},
               config.parking) {}

std::optional<Client> HttpServer::let_in() {
  std::optional<Accepted> at_door = listener_.accept();
  if (!at_door) return std::nullopt;
  const std::string& address = at_door->address;
  const bool counted = !is_loopback(address) && !uses_.trusted_proxies.contains(address);
  Places::Refusal refusal = Places::Refusal::none;
  Client client{.transport = nullptr, .address = address};
  client.place = places_.take(address, counted, refusal);
  if (client.place && tls_) {
    client.transport = tls_->accept(at_door->socket);
    return client;
  }
  client.transport = std::make_unique<Transport>(at_door->socket);
  if (client.place) return client;
  turn_away(client, no_place(refusal));
  client.transport.reset();
  return client;
}

/// Says why, as far as that goes without waiting, and without TLS.
void HttpServer::turn_away(Client& client, const Error& error) const {
  const std::string text = plain_refusal(error);
  const bool said = !tls_ || !client.received.empty();
  const std::int64_t sent = said ? client.transport->send(text) : 0;
  client.transport->end();
  observe_refusal(client.address, error, std::max<std::int64_t>(sent, 0));
}

void HttpServer::make_ready(Client client) {
  const std::lock_guard lock(mutex_);
  ready_.push_back(std::move(client));
  arrived_.notify_one();
}

void HttpServer::serve() {
  std::vector<std::jthread> threads;
  threads.reserve(static_cast<std::size_t>(config_.max_requests));
  for (int i = 0; i < config_.max_requests; ++i) threads.emplace_back([this] { work(); });
  parking_.run();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  arrived_.notify_all();
  end_late();
}

/// Who is not done in time is cut off: an upload must not hold up the end.
void HttpServer::end_late() {
  std::unique_lock lock(mutex_);
  const auto done = [&] { return ready_.empty() && served_.empty(); };
  if (left_.wait_for(lock, config_.last_answers, done)) return;
  log_.warning("connections cut off by the shutdown", {{"connections", served_.size()}});
  for (const int socket : served_) ::shutdown(socket, SHUT_RDWR);
  ready_.clear();
}

void HttpServer::work() {
  while (true) {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return stopping_ || !ready_.empty(); });
    if (ready_.empty()) return;
    Client client = std::move(ready_.front());
    ready_.pop_front();
    const int socket = client.transport->socket();
    served_.insert(socket);
    lock.unlock();
    serve_client(std::move(client));
  }
}

void HttpServer::serve_client(Client client) {
  Connection connection(std::move(client), listener_.stop_descriptor(), config_.limits);
  bool again = false;
  try {
    again = serve_requests(connection);
  } catch (const std::exception& error) {
    log_.error("a connection failed", {{"reason", error.what()}});
  }
  {
    const std::lock_guard lock(mutex_);
    served_.erase(connection.socket());
  }
  left_.notify_all();
  if (again) parking_.park(connection.release());
}

/// True when the client may send another request.
bool HttpServer::serve_requests(Connection& connection) {
  Exchange exchange(connection, uses_, log_);
  try {
    while (connection.next_request()) {
      if (!exchange.answer_request(stopping_)) return false;
      if (!connection.has_next()) return !stopping_;
    }
  } catch (const Error& error) {
    refuse(connection, error);
  }
  return false;
}

void HttpServer::refuse(Connection& connection, const Error& error) const {
  const std::int64_t sent = write_all(connection, plain_refusal(error));
  observe_refusal(connection.client(), error, sent);
}

void HttpServer::observe_refusal(const std::string& client, const Error& error,
                                 std::int64_t sent) const {
  const api::ErrorRow& row = api::error_row(error.code());
  Exchanged done;
  done.client = client;
  done.problem = row.name;
  done.status = row.status;
  done.sent_bytes = sent;
  uses_.observe(done);
}

void HttpServer::stop() { listener_.stop(); }

}  // namespace unwrapd::server
