#pragma once
// Calls to the webhooks of jobs that have ended. The call is a row, written in the transaction that
// ends the job, and goes when it was answered with 2xx: neither a crash nor a receiver that is down
// loses it. Tries go on with doubled pauses, ten in all, until the receiver says 410 (gone). It is
// signed as Standard Webhooks has it: webhook-id, webhook-timestamp, and webhook-signature, the
// HMAC-SHA256 of both and the body under a secret of the job's owner; traceparent is of the job's
// trace. Sixteen calls at once, two to one receiver (webhook_pool.hpp); owners take turns.

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/log.hpp"
#include "server/base/retention_clock.hpp"
#include "server/database/database_address.hpp"
#include "server/webhooks/webhook_http.hpp"
#include "server/webhooks/webhook_pool.hpp"
#include "server/webhooks/webhook_url.hpp"

namespace unwrapd::server::webhooks {

/// The secret under which calls for this owner are signed: "whsec_" and Base64, derived from the
/// server's own.
std::string webhook_secret(std::string_view server_secret, std::string_view owner);

/// "v1," and the Base64 of the HMAC-SHA256 of "id.timestamp.body". Throws Error{internal} when the
/// secret is not of the form of webhook_secret().
std::string webhook_signature(const std::string& secret, std::string_view signed_text);

/// Milliseconds from a call that failed to the next, after so many that had failed before: the
/// first pause, doubled each time; longer when the receiver asks for it; an hour at most.
std::int64_t webhook_pause_ms(int first_seconds, int failed_before, const WebhookAnswer& answer);

/// Thread-safe. The end cuts off the calls that are being made; they are made again at the next
/// start.
class Webhooks {
 public:
  /// store: the database of the jobs, whose tables are there already. now: JobStore::now().
  /// is_shared: other nodes make the calls in it, too.
  Webhooks(const database::DatabaseAddress& store, std::string server_secret, WebhookConfig config,
           const Log& log, std::function<Moment()> now, bool is_shared = false);

  /// Begins the calls that are due as far as there is room. The owner with the fewest calls comes
  /// first, and of its calls the one that was due first. The others follow when there is room.
  void call_due();
  /// Calls that are due, or being made; as they were last, while the store is away.
  [[nodiscard]] std::int64_t due_count();

 private:
  struct Due;
  struct Delivery;

  /// A change by one statement.
  template <class... Values>
  void update(std::string_view sql, const Values&... values) {
    database_->change([&] { database::Statement(*database_, sql).with(values...).run(); });
  }

  void put_forward();
  std::vector<Due> due(std::int64_t now_ms);
  Delivery load(std::int64_t seq);
  void begin(const Due& due);
  [[nodiscard]] bool claim(const Due& due);
  bool make(const Delivery& delivery, const std::stop_token& stop);
  [[nodiscard]] WebhookAnswer call(const Delivery& delivery, const std::stop_token& stop) const;
  void settle(const Delivery& delivery, const WebhookAnswer& answer, std::int64_t now_ms);
  void go_on();

  const std::string secret_;
  const WebhookConfig config_;
  const Log& log_;
  const std::function<Moment()> now_;
  const bool is_shared_;
  std::mutex mutex_;  // of the next two
  const std::shared_ptr<database::Database> database_;
  std::set<std::int64_t> being_made_;  // seq
  std::int64_t counted_due_ = 0;
  WebhookPool pool_;  // last: its threads use the others
};

}  // namespace unwrapd::server::webhooks
