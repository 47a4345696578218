#include "server/jobs/event_exchange.hpp"

#include <algorithm>
#include <exception>
#include <sstream>
#include <utility>

#include "server/base/clock.hpp"
#include "server/base/errors.hpp"

namespace unwrapd::server::jobs {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMostWaiting = 20'000;  // events, while the database is away
constexpr std::size_t kMostAtOnce = 500;
constexpr auto kPauseBetweenWrites = 5ms;
constexpr auto kPauseBetweenSearches = 1s;
constexpr auto kPauseBetweenForgetting = 30s;
constexpr auto kPauseAfterLoss = 500ms;
constexpr std::int64_t kKeptAfterEndMs = 60'000;
constexpr std::size_t kMostIdsInHint = 100;  // a hint has room for 8000 bytes

}  // namespace

EventExchange::EventExchange(database::PostgresAddress address, EventFeed& events,
                             ExchangeCallbacks callbacks, const Log& log)
    : address_(std::move(address)),
      events_(events),
      callbacks_(std::move(callbacks)),
      log_(log),
      exchanging_([this](const std::stop_token& stop) { keep_trying(stop); }) {}

EventExchange::~EventExchange() {
  exchanging_.request_stop();
  bell_.ring();
}

void EventExchange::share(store::EventRow event) {
  {
    const std::lock_guard lock(mutex_);
    to_write_.push_back(std::move(event));
    if (to_write_.size() > kMostWaiting) to_write_.pop_front();
  }
  bell_.ring();
}

void EventExchange::hint(std::string_view what) {
  {
    const std::lock_guard lock(mutex_);
    if (std::ranges::find(to_hint_, what) == to_hint_.end()) to_hint_.emplace_back(what);
  }
  bell_.ring();
}

/// Works with a session, and with another one when that is lost.
void EventExchange::keep_trying(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::string reason;
    try {
      exchange(stop);
    } catch (const database::LinkLost& lost) {
      reason = lost.reason;
    } catch (const std::exception& error) {
      reason = reason_of(error);
    }
    if (stop.stop_requested()) return;
    log_.warning("exchanging news with other nodes is tried again", {{"reason", reason}});
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, stop, kPauseAfterLoss, [] { return false; });
  }
}

/// Without hints, all is found by looking.
void EventExchange::send(store::EventChannel& channel, std::string_view hint) {
  try {
    channel.hint(hint);
    can_hint_ = true;
  } catch (const Error& error) {
    if (std::exchange(can_hint_, false))
      log_.warning("other nodes get no hints, and look once a second",
                   {{"reason", reason_of(error)}});
  }
}

/// What is not written when the session is lost is written by the next one.
void EventExchange::append(store::EventChannel& channel) {
  std::set<std::string> jobs;
  for (const store::EventRow& event : unsent_) jobs.insert(event.job);
  try {
    channel.append(unsent_);
  } catch (const Error& error) {  // tried again, they would hold up all others
    log_.error("events are not told to other nodes",
               {{"events", unsent_.size()}, {"reason", reason_of(error)}});
  }
  unsent_.clear();
  std::string ids;
  if (jobs.size() <= kMostIdsInHint)  // else: of any
    for (const std::string& job : jobs) ids += " " + job;
  send(channel, std::string(kEvents) + ids);
}

bool EventExchange::has_to_write() {
  const std::lock_guard lock(mutex_);
  return !to_write_.empty() || !to_hint_.empty();
}

void EventExchange::write(store::EventChannel& channel) {
  std::vector<std::string> hints;
  {
    const std::lock_guard lock(mutex_);
    hints = std::exchange(to_hint_, {});
    for (; !to_write_.empty() && unsent_.size() < kMostAtOnce; to_write_.pop_front())
      unsent_.push_back(std::move(to_write_.front()));
  }
  for (const std::string& hint : hints) send(channel, hint);
  if (!unsent_.empty()) append(channel);
}

/// At an end of the server, the last events are written.
void EventExchange::exchange(const std::stop_token& stop) {
  store::EventChannel channel(address_);
  channel.listen();
  if (!unsent_.empty()) append(channel);
  Clock::time_point next_search{}, next_write{};
  Clock::time_point next_forgetting = Clock::now() + kPauseBetweenForgetting;
  while (!stop.stop_requested()) {
    if (Clock::now() >= next_search) {
      look_around(channel);
      next_search = Clock::now() + kPauseBetweenSearches;
    }
    if (Clock::now() >= next_forgetting) {
      channel.forget_before(now_ms() - kKeptAfterEndMs);
      next_forgetting = Clock::now() + kPauseBetweenForgetting;
    }
    if (has_to_write() && Clock::now() >= next_write) {
      write(channel);
      next_write = Clock::now() + kPauseBetweenWrites;
    }
    const Clock::time_point until =
        has_to_write() ? std::min(next_search, next_write) : next_search;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    take_hints(channel, channel.wait(std::max(left, 0ms), bell_));
  }
  while (has_to_write()) write(channel);
}

void EventExchange::take_hints(store::EventChannel& channel,
                               const std::vector<std::string>& hints) {
  std::set<std::string> with_news;
  bool of_any = must_fetch_.exchange(false);
  for (const std::string& hint : hints) of_any |= !take_hint(hint, with_news);
  if (!of_any && with_news.empty()) return;
  Feeds feeds = events_.following();
  if (!of_any)
    std::erase_if(feeds, [&](const auto& followed) {
      return !with_news.contains(followed.first) && followed.second->newest() > 0;
    });
  fetch(channel, feeds);
}

/// False for a hint that there are events without saying of which jobs.
bool EventExchange::take_hint(const std::string& hint, std::set<std::string>& with_news) {
  if (hint == kJobsWait) callbacks_.jobs_wait();
  if (hint == kCancelled) callbacks_.jobs_cancelled();
  if (!hint.starts_with(kEvents)) return true;
  std::istringstream ids(hint.substr(kEvents.size()));
  bool names_jobs = false;
  for (std::string id; ids >> id; names_jobs = true) with_news.insert(id);
  return names_jobs;
}

void EventExchange::fetch(store::EventChannel& channel, const Feeds& feeds) {
  for (std::size_t begin = 0; begin < feeds.size(); begin += kMostAtOnce) {
    const std::size_t end = std::min(begin + kMostAtOnce, feeds.size());
    std::map<std::string, std::shared_ptr<JobFeed>> by_job(
        feeds.begin() + static_cast<std::ptrdiff_t>(begin),
        feeds.begin() + static_cast<std::ptrdiff_t>(end));
    std::vector<store::EventChannel::JobAndSeq> seen;
    for (const auto& [job, feed] : by_job) seen.emplace_back(job, feed->newest());
    for (const store::EventRow& event : channel.after(seen)) {
      by_job.at(event.job)->append(event);
      if (event.is_last) events_.retire(event.job);
    }
    for (const auto& [job, feed] : by_job) feed->set_caught_up();
  }
}

/// Finds what no hint told of. The end of a job comes with its events, which are written a little
/// later than its row: it is told without them only where they do not come until the next look.
void EventExchange::look_around(store::EventChannel& channel) {
  callbacks_.jobs_wait();
  callbacks_.jobs_cancelled();
  const Feeds feeds = events_.following();
  fetch(channel, feeds);
  std::vector<store::EventChannel::JobAndSeq> followed;
  for (const auto& [job, feed] : events_.following()) followed.emplace_back(job, 0);
  std::set<std::string> ended;
  if (!followed.empty())
    for (std::string& job : channel.ended(followed)) ended.insert(std::move(job));
  for (const std::string& job : ended)
    if (ended_before_.contains(job)) callbacks_.job_ended(job);
  ended_before_ = std::move(ended);
}

}  // namespace unwrapd::server::jobs
