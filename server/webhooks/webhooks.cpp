#include "server/webhooks/webhooks.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <map>

#include "core/base/error.hpp"
#include "server/base/clock.hpp"
#include "server/base/errors.hpp"
#include "server/base/identity.hpp"
#include "server/base/trace.hpp"
#include "server/outbound/curl_library.hpp"

namespace unwrapd::server::webhooks {
namespace {

constexpr std::string_view kSecretPrefix = "whsec_";
constexpr int kMaxTries = 10;
constexpr int kAtOnce = 16;
constexpr int kPerReceiver = 2;
constexpr std::int64_t kLongestPauseMs = 3'600'000;
constexpr std::int64_t kLongestCallMs = 60'000;
constexpr std::int64_t kTimeForOthersMs = 3'600'000;

bool may_call(const std::string& url, const WebhookConfig& config) {
  try {
    static_cast<void>(parse_webhook(url, config));
    return true;
  } catch (const Error&) {
    return false;
  }
}

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

/// A call that is still to be answered.
struct Webhooks::Delivery {
  std::int64_t seq = 0;
  std::string job;
  std::string owner;  ///< of the job, which may be removed meanwhile
  std::string trace;  ///< of the job
  std::string url;
  std::string body;
  int tries = 0;
};

/// A call that is due.
struct Webhooks::Due {
  std::int64_t seq;
  std::string owner;
  std::string url;
  std::int64_t due_ms;
  int turn;  ///< calls of its owner that come before it
};

std::string webhook_secret(std::string_view server_secret, std::string_view owner) {
  const std::string bytes = hmac_sha256(server_secret, "webhooks of " + std::string(owner));
  return std::string(kSecretPrefix) + base64(bytes);
}

std::string webhook_signature(const std::string& secret, std::string_view signed_text) {
  const std::string key = from_base64(std::string_view(secret).substr(kSecretPrefix.size()));
  return "v1," + base64(hmac_sha256(key, signed_text));
}

std::int64_t webhook_pause_ms(int first_seconds, int failed_before, const WebhookAnswer& answer) {
  const std::int64_t own_ms = (first_seconds * kMsPerSecond) << failed_before;
  const std::int64_t asked_s = std::min<std::int64_t>(answer.retry_after.count(), kLongestPauseMs);
  return std::min(std::max(own_ms, asked_s * kMsPerSecond), kLongestPauseMs);
}

Webhooks::Webhooks(const database::DatabaseAddress& store, std::string server_secret,
                   WebhookConfig config, const Log& log, std::function<Moment()> now,
                   bool is_shared)
    : secret_(std::move(server_secret)),
      config_(std::move(config)),
      log_(log),
      now_(std::move(now)),
      is_shared_(is_shared),
      database_(store.open()),
      pool_(kAtOnce, kPerReceiver, [this] { go_on(); }) {
  if (!config_.allowed_hosts.empty())
    outbound::CurlLibrary::loaded();  // tells at the start if it is missing
  try {
    put_forward();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::storage_full) throw;
    log_.warning("the disk is full, calls of webhooks may be late");
  }
}

/// Makes calls due that were put off when the clock was set back while no server ran.
void Webhooks::put_forward() {
  const database::Dialect& sql = database_->dialect();
  const std::string failed = std::string(sql.greatest) + "(tries - 1, 0)";
  const std::string latest =
      "?1 + " + std::string(sql.least) + "(?2 << CAST(" + failed + " AS INTEGER), ?3)";
  update("UPDATE deliveries SET due_ms = " + latest + " WHERE due_ms > " + latest, now_().kept_ms(),
         config_.retry_seconds * kMsPerSecond, kLongestPauseMs);
}

std::int64_t Webhooks::due_count() {
  const std::lock_guard lock(mutex_);
  try {
    database::Statement count(*database_, "SELECT COUNT(*) FROM deliveries WHERE due_ms <= ?");
    count.with(now_().kept_ms()).step();
    counted_due_ = count.number(0);
  } catch (const Error&) {  // it is told elsewhere that the store is away
  }
  return counted_due_;
}

/// The calls that are due and not being made, in the order of their turns.
std::vector<Webhooks::Due> Webhooks::due(std::int64_t now_ms) {
  database::Statement statement(
      *database_,
      "SELECT seq, owner, url, due_ms FROM deliveries WHERE due_ms <= ? ORDER BY due_ms");
  statement.with(now_ms);
  std::vector<Due> found;
  std::map<std::string, int> turns;
  while (statement.step()) {
    if (being_made_.contains(statement.number(0))) continue;
    const std::string owner = statement.text(1);
    const auto [turn, is_first] = turns.try_emplace(owner);
    if (is_first) turn->second = pool_.of_owner(owner);
    found.push_back({.seq = statement.number(0),
                     .owner = owner,
                     .url = statement.text(2),
                     .due_ms = statement.number(3),
                     .turn = turn->second++});
  }
  std::ranges::stable_sort(found, {}, &Due::turn);
  return found;
}

Webhooks::Delivery Webhooks::load(std::int64_t seq) {
  database::Statement statement(
      *database_, "SELECT job, owner, trace, url, body, tries FROM deliveries WHERE seq = ?");
  statement.with(seq).step();
  return {.seq = seq,
          .job = statement.text(0),
          .owner = statement.text(1),
          .trace = statement.text(2),
          .url = statement.text(3),
          .body = statement.text(4),
          .tries = static_cast<int>(statement.number(5))};
}

WebhookAnswer Webhooks::call(const Delivery& delivery, const std::stop_token& stop) const {
  try {
    const WebhookUrl url = parse_webhook(delivery.url, config_);
    const std::string address = resolve_webhook(url, config_).front();
    const std::string timestamp = std::to_string(now_().of_day_ms / kMsPerSecond);
    const std::string signed_text = delivery.job + "." + timestamp + "." + delivery.body;
    return post_webhook(
        {.url = url,
         .address = address,
         .headers = {{"webhook-id", delivery.job},
                     {"webhook-timestamp", timestamp},
                     {"traceparent", to_traceparent(step_of(delivery.trace))},
                     {"webhook-signature",
                      webhook_signature(webhook_secret(secret_, delivery.owner), signed_text)}},
         .body = delivery.body},
        stop);
  } catch (const Error& error) {
    return {.failure = error.what()};
  }
}

void Webhooks::settle(const Delivery& delivery, const WebhookAnswer& answer, std::int64_t now_ms) {
  const int tries = delivery.tries + 1;
  const std::string& failure = answer.failure;
  const bool is_last = tries >= kMaxTries || answer.is_gone;
  if (failure.empty() || is_last) {
    update("DELETE FROM deliveries WHERE seq = ?", delivery.seq);
  } else {
    update("UPDATE deliveries SET tries = ?2, due_ms = ?3 WHERE seq = ?1", delivery.seq,
           std::int64_t{tries},
           now_ms + webhook_pause_ms(config_.retry_seconds, delivery.tries, answer));
  }
  if (failure.empty()) {
    log_.info("webhook called", {{"job", delivery.job}, {"tries", tries}});
  } else {  // neither the address, which may hold a token, nor the signature
    log_.warning(is_last ? "webhook given up" : "webhook not reached",
                 {{"job", delivery.job}, {"tries", tries}, {"reason", failure}});
  }
}

/// True when the receiver has answered. A call whose outcome cannot be stored is made again: once
/// too often rather than never.
bool Webhooks::make(const Delivery& delivery, const std::stop_token& stop) {
  const TraceScope trace(delivery.trace);
  const WebhookAnswer answer = call(delivery, stop);
  const std::lock_guard lock(mutex_);
  being_made_.erase(delivery.seq);
  if (stop.stop_requested() && !answer.failure.empty()) return false;  // cut off by us
  try {
    settle(delivery, answer, now_().kept_ms());
  } catch (const Error& error) {
    log_.error("a webhook's call was not noted", {{"reason", reason_of(error)}});
  }
  return answer.failure.empty();
}

/// Keeps other nodes from making the same call, for longer than it takes. Should this node end
/// meanwhile, it is due again then. A call that this node may not make is left to those that may;
/// where none does for an hour, it fails here, as all calls end some time.
bool Webhooks::claim(const Due& due) {
  if (!is_shared_) return true;
  const bool is_late = now_().kept_ms() - due.due_ms > kTimeForOthersMs;
  if (!is_late && !may_call(due.url, config_)) return false;
  return database_->change([&] {
    database::Statement(*database_,
                        "UPDATE deliveries SET due_ms = ?3 WHERE seq = ?1 AND due_ms = ?2")
        .with(due.seq, due.due_ms, now_().kept_ms() + kLongestCallMs)
        .run();
    return database_->changes() == 1;
  });
}

void Webhooks::begin(const Due& due) {
  const WebhookReceiver receiver{.owner = due.owner, .host = webhook_host(due.url)};
  if (!pool_.has_room(receiver) || !claim(due)) return;
  Delivery delivery = load(due.seq);
  being_made_.insert(due.seq);
  pool_.begin(receiver, [this, delivery = std::move(delivery)](const std::stop_token& stop) {
    return make(delivery, stop);
  });
}

void Webhooks::call_due() {
  const std::lock_guard lock(mutex_);
  if (pool_.is_full()) return;
  for (const Due& next : due(now_().kept_ms())) {
    begin(next);
    if (pool_.is_full()) return;
  }
}

void Webhooks::go_on() {
  try {
    call_due();
  } catch (const Error& error) {
    log_.error("calling webhooks failed", {{"reason", reason_of(error)}});
  }
}

}  // namespace unwrapd::server::webhooks
