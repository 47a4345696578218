#include "server/webhooks/webhook_http.hpp"

#include "server/outbound/transfer.hpp"

namespace unwrapd::server::webhooks {
namespace {

constexpr std::chrono::seconds kWhole{15};
constexpr int kGone = 410;

WebhookAnswer answer(const outbound::Transfer& transfer, CURLcode result) {
  if (!transfer.has_answer())
    return {.failure = std::string("no answer: ") + transfer.words(result)};
  const long status = transfer.status();
  if (status >= 200 && status < 300) return {};
  return {.failure = "status " + std::to_string(status),
          .is_gone = status == kGone,
          .retry_after = transfer.retry_after()};
}

}  // namespace

WebhookAnswer post_webhook(const WebhookCall& call, const std::stop_token& stop) {
  outbound::Transfer transfer(call.url, call.address, kWhole);
  for (const auto& [name, value] : call.headers) transfer.add_header(name + ": " + value);
  transfer.add_header("Content-Type: application/json");
  transfer.set_post(call.body);
  return answer(transfer, transfer.run(stop));
}

}  // namespace unwrapd::server::webhooks
