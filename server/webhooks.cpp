#include "server/webhooks.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <array>

#include "core/error.hpp"
#include "server/identity.hpp"
#include "server/webhook_http.hpp"

namespace unwrapd::server {
namespace {

constexpr std::string_view kSecretPrefix = "whsec_";
constexpr int kMaxTries = 10;
constexpr int kDueAtOnce = 50;
constexpr std::int64_t kMsPerSecond = 1000;
constexpr std::int64_t kLongestPauseMs = 3'600'000;

std::string base64(std::string_view bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // EVP ends it with a NUL
  const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), from,
                                   static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

std::string from_base64(std::string_view text) {
  std::string bytes(text.size() / 4 * 3, '\0');
  const auto* from = reinterpret_cast<const unsigned char*>(text.data());
  const int size = EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()), from,
                                   static_cast<int>(text.size()));
  if (size < 1) throw Error(ErrorCode::internal, "The secret of webhooks cannot be read.");
  const auto padding = std::ranges::count(text, '=');
  bytes.resize(static_cast<std::size_t>(size - padding));
  return bytes;
}

}  // namespace

std::string webhook_secret(std::string_view server_secret, std::string_view owner) {
  const std::string bytes = hmac_sha256(server_secret, "webhooks of " + std::string(owner));
  return std::string(kSecretPrefix) + base64(bytes);
}

std::string webhook_signature(const std::string& secret, std::string_view signed_text) {
  const std::string key = from_base64(std::string_view(secret).substr(kSecretPrefix.size()));
  return "v1," + base64(hmac_sha256(key, signed_text));
}

Webhooks::Webhooks(const std::filesystem::path& store, std::string server_secret,
                   WebhookConfig config, const Log& log)
    : database_(store), secret_(std::move(server_secret)), config_(std::move(config)), log_(log) {}

std::vector<Delivery> Webhooks::due(std::int64_t now_ms) {
  Statement statement(database_,
                      "SELECT d.seq, d.job, COALESCE(j.owner, ''), d.url, d.body, d.tries"
                      " FROM deliveries d LEFT JOIN jobs j ON j.id = d.job"
                      " WHERE d.due_ms <= ? ORDER BY d.due_ms LIMIT ?");
  statement.with(now_ms, std::int64_t{kDueAtOnce});
  std::vector<Delivery> found;
  while (statement.step()) {
    found.push_back({.seq = statement.number(0),
                     .job = statement.text(1),
                     .owner = statement.text(2),
                     .url = statement.text(3),
                     .body = statement.text(4),
                     .tries = static_cast<int>(statement.number(5))});
  }
  return found;
}

std::string Webhooks::call(const Delivery& delivery, std::int64_t now_ms) const {
  try {
    const WebhookUrl url = parse_webhook(delivery.url, config_);
    const std::string address = resolve_webhook(url, config_).front();
    const std::string timestamp = std::to_string(now_ms / kMsPerSecond);
    const std::string signed_text = delivery.job + "." + timestamp + "." + delivery.body;
    return post_webhook(
        {.url = url,
         .address = address,
         .headers = {{"webhook-id", delivery.job},
                     {"webhook-timestamp", timestamp},
                     {"webhook-signature",
                      webhook_signature(webhook_secret(secret_, delivery.owner), signed_text)}},
         .body = delivery.body});
  } catch (const Error& error) {
    return error.what();
  }
}

void Webhooks::settle(const Delivery& delivery, const std::string& failure, std::int64_t now_ms) {
  const int tries = delivery.tries + 1;
  if (failure.empty() || tries >= kMaxTries) {
    Statement(database_, "DELETE FROM deliveries WHERE seq = ?").with(delivery.seq).run();
  } else {
    const std::int64_t first_ms = config_.retry_seconds * kMsPerSecond;
    const std::int64_t pause_ms = std::min(first_ms << delivery.tries, kLongestPauseMs);
    Statement(database_, "UPDATE deliveries SET tries = ?2, due_ms = ?3 WHERE seq = ?1")
        .with(delivery.seq, std::int64_t{tries}, now_ms + pause_ms)
        .run();
  }
  if (failure.empty()) {
    log_.info("webhook called", {{"job", delivery.job}, {"tries", tries}});
  } else {  // neither the address, which may hold a token, nor the signature
    log_.warning(tries >= kMaxTries ? "webhook given up" : "webhook not reached",
                 {{"job", delivery.job}, {"tries", tries}, {"reason", failure}});
  }
}

void Webhooks::call_due(std::int64_t now_ms) {
  for (const Delivery& delivery : due(now_ms)) settle(delivery, call(delivery, now_ms), now_ms);
}

}  // namespace unwrapd::server
