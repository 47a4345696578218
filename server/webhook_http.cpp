#include "server/webhook_http.hpp"

#include <httplib.h>

#include <chrono>

#include "server/deadline.hpp"

namespace unwrapd::server {
namespace {

constexpr std::chrono::seconds kConnectTime{5};
constexpr std::chrono::seconds kWholeTime{15};

/// A Client or an SSLClient.
template <class Client>
std::string post(Client& client, const WebhookCall& call, const std::stop_token& stop) {
  client.set_hostname_addr_map({{call.url.host, call.address}});
  client.set_connection_timeout(kConnectTime);
  client.set_read_timeout(kWholeTime);
  client.set_write_timeout(kWholeTime);
  client.set_follow_location(false);
  int status = 0;
  httplib::Request request;
  request.method = "POST";
  request.path = call.url.target;
  for (const auto& [name, value] : call.headers) request.set_header(name.c_str(), value);
  request.set_header("Content-Type", "application/json");
  request.body = call.body;
  request.response_handler = [&](const httplib::Response& answer) {
    status = answer.status;
    return false;  // the body is not read: it may have no end
  };
  const Deadline slow(kWholeTime, [&] { client.stop(); });
  const std::stop_callback cut(stop, [&] { client.stop(); });
  const httplib::Result result = client.send(request);
  if (result) status = result->status;  // of an answer that can have no body, such as 204
  if (status >= 200 && status < 300) return {};
  if (status != 0) return "status " + std::to_string(status);
  return "no answer: " + httplib::to_string(result.error());
}

}  // namespace

std::string post_webhook(const WebhookCall& call, const std::stop_token& stop) {
  if (call.url.is_https) {
    httplib::SSLClient client(call.url.host, call.url.port);
    return post(client, call, stop);
  }
  httplib::ClientImpl client(call.url.host, call.url.port);
  return post(client, call, stop);
}

}  // namespace unwrapd::server
