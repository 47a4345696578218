#include "server/http/http_server.hpp"

#include <sys/socket.h>

#include <exception>
#include <system_error>
#include <utility>

#include "api/error_table.hpp"
#include "server/base/errors.hpp"

namespace unwrapd::server::http {
namespace {

constexpr int kRetrySeconds = 5;
constexpr int kHandshakeThreads = 2;  // they only compute: one for each core of a small machine

/// A refusal before httplib has seen the request.
std::string plain_refusal(const Error& error) {
  const Response response = error_response(error);
  const auto& body = std::get<std::string>(response.body);
  std::string text = "HTTP/1.1 " + std::to_string(response.status) + " Refused\r\n";
  for (const auto& [name, value] : response.headers)
    text.append(name).append(": ").append(value).append("\r\n");
  return text + "X-Content-Type-Options: nosniff\r\nCache-Control: no-store\r\nContent-Type: " +
         response.content_type + "\r\nContent-Length: " + std::to_string(body.size()) +
         "\r\nConnection: close\r\n\r\n" + body;
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

RetryLater no_place(ConcurrencyLimit::Refusal why) {
  const bool is_full = why == ConcurrencyLimit::Refusal::full;
  const std::string whose = is_full ? "" : " from this address";
  return {ErrorCode::rate_limited,
          "Too many connections are open" + whose + "; use fewer, or try again after Retry-After.",
          kRetrySeconds};
}

std::optional<TlsContext> tls_of(const HttpConfig& config) {
  if (config.tls_certificate.empty()) return std::nullopt;
  return std::optional<TlsContext>(std::in_place, config.tls_certificate, config.tls_key);
}

/// most: connections of one network, 0 for no limit.
ConcurrencyLimit::Share share_of_network(int most) {
  return [most](int places, int) { return most > 0 ? most : places; };
}

/// Half of the threads may wait for clients that are slow.
HttpConfig with_pressure(HttpConfig config) {
  config.limits.pressure = std::make_shared<SlowClientPressure>();
  config.limits.pressure->many = config.max_requests / 2;
  return config;
}

}  // namespace

/// A thread that waits for a client.
struct HttpServer::Idle {
  std::condition_variable wake;
  bool is_woken = false;
};

HttpServer::HttpServer(const HttpConfig& config, HttpUses uses, const Log& log)
    : config_(with_pressure(config)),
      uses_(std::move(uses)),
      log_(log),
      tls_(tls_of(config)),
      listener_(config.address.host, config.address.port, config.option),
      places_(config.max_connections, share_of_network(config.max_connections_per_address)),
      idle_connections_(
          listener_,
          {.accept = [this] { return let_in(); },
           .handshake = [this](Client client) { handshakes_->handshake(std::move(client)); },
           .ready = [this](Client client) { make_ready(std::move(client)); },
           .refuse = [this](Client& client, const Error& why) { turn_away(client, why); }},
          config.idle_connections),
      streams_({.news = uses_.news,
                .observe = uses_.observe,
                .back = [this](Client client, bool again) { let_go(std::move(client), again); }},
               config.limits, config.ping) {
  if (tls_)
    handshakes_.emplace(kHandshakeThreads,
                        [this](Client client) { idle_connections_.park(std::move(client)); });
}

std::optional<Client> HttpServer::let_in() {
  std::optional<Accepted> at_door = listener_.accept();
  if (!at_door) return std::nullopt;
  const std::string& address = at_door->address;
  const bool counted = !is_loopback(address) && !uses_.trusted_proxies.contains(address);
  ConcurrencyLimit::Refusal refusal{};
  Client client{.transport = nullptr, .address = address};
  client.place = places_.try_enter(counted ? network_of(address) : "", &refusal);
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

/// Sends the reason, if that needs neither waiting nor TLS.
void HttpServer::turn_away(Client& client, const Error& error) const {
  const std::string text = plain_refusal(error);
  const bool said = !tls_ || !client.received.empty();
  const std::int64_t sent = said ? client.transport->send(text) : 0;
  client.transport->end();
  observe_refusal(client.address, error, std::max<std::int64_t>(sent, 0));
}

/// Wakes the thread that became idle last, whose stack and memory are warm, or starts a new one.
/// Rejected: waking any thread, which goes round all of them and made each keep its own memory.
void HttpServer::make_ready(Client client) {
  const std::lock_guard lock(mutex_);
  ready_.push_back(std::move(client));
  if (!idle_.empty()) {
    wake(*idle_.back());
    idle_.pop_back();
  } else if (std::ssize(threads_) < std::int64_t{config_.max_requests} + config_.max_held) {
    begin_thread();
  }
}

void HttpServer::wake(Idle& idle) {
  idle.is_woken = true;
  idle.wake.notify_one();
}

void HttpServer::begin_thread() {
  try {
    threads_.emplace_back([this] { work(); });
  } catch (const std::system_error& error) {  // those that there are go on
    log_.error("a thread could not be started",
               {{"threads", threads_.size()}, {"reason", reason_of(error)}});
  }
}

void HttpServer::serve() {
  idle_connections_.run();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    for (Idle* idle : idle_) wake(*idle);
    idle_.clear();
  }
  end_late();
  threads_.clear();
  streams_.stop();
}

/// Cuts off clients that are not done in time: an upload must not delay the end.
void HttpServer::end_late() {
  std::unique_lock lock(mutex_);
  const auto done = [&] { return ready_.empty() && served_.empty(); };
  if (left_.wait_for(lock, config_.last_answers, done)) return;
  log_.warning("connections cut off by the shutdown", {{"connections", served_.size()}});
  for (const int socket : served_) ::shutdown(socket, SHUT_RDWR);
  ready_.clear();
}

/// The next client to serve; nothing at the end.
std::optional<Client> HttpServer::next_client() {
  Idle self;
  std::unique_lock lock(mutex_);
  while (ready_.empty() && !stopping_) {
    self.is_woken = false;
    idle_.push_back(&self);
    self.wake.wait(lock, [&] { return self.is_woken; });
  }
  if (ready_.empty()) return std::nullopt;
  std::optional<Client> client = std::move(ready_.front());
  ready_.pop_front();
  served_.insert(client->transport->socket());
  return client;
}

void HttpServer::work() {
  Exchange exchange(uses_, log_, config_.idle_connections.idle);
  while (std::optional<Client> client = next_client()) serve_client(std::move(*client), exchange);
}

void HttpServer::serve_client(Client client, Exchange& exchange) {
  Connection connection(std::move(client), listener_.stop_descriptor(), config_.limits);
  bool again = false;
  try {
    again = serve_requests(connection, exchange);
  } catch (const std::exception& error) {
    log_.error("a connection failed", {{"reason", reason_of(error)}});
  }
  if (std::optional<OpenStream> stream = exchange.take_stream())
    return streams_.take(connection.release(), std::move(*stream));
  if (again) return let_go(connection.release(), true);
  forget(connection.socket());
}

/// Handles a client that may send another request, or whose stream has ended.
void HttpServer::let_go(Client client, bool again) {
  forget(client.transport->socket());
  if (again && !stopping_) return idle_connections_.park(std::move(client));
  client.transport->end();
}

void HttpServer::forget(int socket) {
  {
    const std::lock_guard lock(mutex_);
    served_.erase(socket);
  }
  left_.notify_all();
}

/// True when the client may send another request.
bool HttpServer::serve_requests(Connection& connection, Exchange& exchange) {
  try {
    while (connection.next_request()) {
      if (!exchange.answer_request(connection, stopping_)) return false;
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

}  // namespace unwrapd::server::http
