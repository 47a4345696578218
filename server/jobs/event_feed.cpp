#include "server/jobs/event_feed.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "server/base/trace.hpp"

namespace unwrapd::server::jobs {
namespace {

constexpr std::int64_t kSeqsPerAttempt = 1'000'000'000;
constexpr std::size_t kMaxReadingBytes = std::size_t{4} * 1024;  // at once, kept for each reader

}  // namespace

JobFeed::JobFeed(std::int64_t base, std::size_t capacity, Metrics* metrics,
                 std::shared_ptr<const Wakeup> news)
    : base_(base),
      trace_(current_trace().empty() ? new_trace_id() : current_trace()),
      news_(std::move(news)),
      newest_(base),
      capacity_(capacity) {
  if (metrics) watch_.emplace(*metrics);
}

void JobFeed::publish(const std::function<api::Event(std::int64_t seq)>& make) {
  bool is_last = false;
  {
    const std::lock_guard lock(mutex_);
    if (over()) return;
    const api::Event event = make(newest_ + 1);
    if (watch_) watch_->see(event);
    ring_.push_back({event.seq, api::sse_frame(event)});
    newest_ = event.seq;
    if (ring_.size() > capacity_) ring_.pop_front();
    finished_ = is_last = api::is_last(event);
  }
  tell_news(is_last);
}

void JobFeed::tell_news(bool is_over) {
  if (is_over) over_.notify_all();
  if (news_) news_->ring();
}

void JobFeed::set_progress(const api::JobProgress& progress) {
  const std::lock_guard lock(mutex_);
  progress_ = progress;
}

std::optional<api::JobProgress> JobFeed::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

void JobFeed::end() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  tell_news(true);
}

std::int64_t JobFeed::next_seq() const {
  const std::lock_guard lock(mutex_);
  return newest_ + 1;
}

std::int64_t JobFeed::resume_after(std::optional<std::int64_t> last_event_id) const {
  const std::lock_guard lock(mutex_);
  if (!last_event_id || *last_event_id > newest_) return base_;
  return finished_ ? std::min(*last_event_id, newest_ - 1) : *last_event_id;
}

Reading JobFeed::read(std::int64_t after) const {
  const std::lock_guard lock(mutex_);
  Reading reading{.frames = {}, .last_seq = after, .end = false};
  if (!ring_.empty() && ring_.front().seq > after + 1) {
    reading.last_seq = ring_.front().seq - 1;
    reading.frames = api::sse_frame(api::gap_event(after + 1, reading.last_seq));
  }
  while (!ring_.empty() && reading.last_seq < newest_) {
    if (reading.frames.size() > kMaxReadingBytes) return reading;
    const auto behind = static_cast<std::size_t>(newest_ - reading.last_seq);
    reading.frames += ring_[ring_.size() - behind].text;
    ++reading.last_seq;
  }
  reading.end = over();
  return reading;
}

bool JobFeed::wait_finished(std::chrono::steady_clock::time_point until) const {
  std::unique_lock lock(mutex_);
  over_.wait_until(lock, until, [&] { return over(); });
  return finished_;
}

std::shared_ptr<JobFeed> EventFeed::open(const std::string& job, int attempt) {
  const std::lock_guard lock(mutex_);
  auto feed = std::make_shared<JobFeed>(attempt * kSeqsPerAttempt, ring_, metrics_, news_);
  feeds_[job] = feed;
  return feed;
}

std::shared_ptr<JobFeed> EventFeed::find(std::string_view job) const {
  const std::lock_guard lock(mutex_);
  const auto found = feeds_.find(job);
  return found == feeds_.end() ? nullptr : found->second;
}

void EventFeed::retire(const std::string& job) {
  const std::lock_guard lock(mutex_);
  finished_.push_back(job);
  if (finished_.size() <= kept_finished_) return;
  feeds_.erase(finished_.front());
  finished_.pop_front();
}

void EventFeed::forget(const std::string& job) {
  const std::lock_guard lock(mutex_);
  feeds_.erase(job);
  finished_.remove(job);
}

void EventFeed::end_all() {
  std::vector<std::shared_ptr<JobFeed>> feeds;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [job, feed] : feeds_) feeds.push_back(feed);
  }
  for (const auto& feed : feeds) feed->end();
}

}  // namespace unwrapd::server::jobs
