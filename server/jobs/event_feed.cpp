#include "server/jobs/event_feed.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "server/base/trace.hpp"

namespace unwrapd::server::jobs {
namespace {

constexpr std::size_t kMaxReadingBytes = std::size_t{4} * 1024;  // at once, kept for each reader
constexpr std::chrono::milliseconds kTimeToCatchUp{300};

/// Whether an event has the first number of a part.
bool begins_part(std::int64_t seq) {
  const std::int64_t before = (seq - 1) % kSeqsPerAttempt;
  return before == 0 || before == kSeqsOfEnds || before == kSeqsOfRun;
}

}  // namespace

JobFeed::JobFeed(std::int64_t base, std::size_t capacity, Metrics* metrics,
                 std::shared_ptr<const Wakeup> news, Share share, std::chrono::milliseconds waited)
    : base_(base),
      trace_(current_trace().empty() ? new_trace_id() : current_trace()),
      news_(std::move(news)),
      share_(std::move(share)),
      newest_(base),
      forgotten_(base),
      capacity_(capacity) {
  if (metrics) watch_.emplace(*metrics, waited);
}

/// Requires the mutex.
void JobFeed::keep(Frame frame) {
  newest_ = frame.seq;
  ring_.push_back(std::move(frame));
  if (ring_.size() <= capacity_) return;
  forgotten_ = ring_.front().seq;
  ring_.pop_front();
}

void JobFeed::publish(const std::function<api::Event(std::int64_t seq)>& make) {
  bool is_last = false;
  {
    const std::lock_guard lock(mutex_);
    if (over()) return;
    const api::Event event = make(newest_ + 1);
    if (watch_) watch_->see(event);
    keep({event.seq, api::sse_frame(event)});
    finished_ = is_last = api::is_last(event);
    if (share_)
      share_({.job = {},
              .seq = event.seq,
              .is_last = is_last,
              .frame = ring_.back().text,
              .progress = progress_ ? api::to_json(*progress_).dump() : std::string()});
  }
  tell_news(is_last);
}

void JobFeed::append(const store::EventRow& event) {
  {
    const std::lock_guard lock(mutex_);
    if (over() || !following_ || event.seq <= newest_) return;
    if (event.seq > newest_ + 1 && !begins_part(event.seq))
      keep({event.seq - 1, api::sse_frame(api::gap_event(newest_ + 1, event.seq - 1))});
    keep({event.seq, event.frame});
    if (!event.progress.empty()) progress_ = api::progress_of(api::Json::parse(event.progress));
    finished_ = event.is_last;
  }
  tell_news(event.is_last);
}

void JobFeed::rise_to(std::int64_t seq) {
  const std::lock_guard lock(mutex_);
  newest_ = std::max(newest_, seq);
}

bool JobFeed::is_finished() const {
  const std::lock_guard lock(mutex_);
  return over();
}

std::int64_t JobFeed::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

void JobFeed::set_caught_up() {
  {
    const std::lock_guard lock(mutex_);
    caught_up_ = true;
  }
  over_.notify_all();
}

void JobFeed::wait_caught_up(std::chrono::milliseconds at_most) const {
  std::unique_lock lock(mutex_);
  over_.wait_for(lock, at_most, [&] { return caught_up_ || over(); });
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

/// Numbers rise, with gaps between attempts.
Reading JobFeed::read(std::int64_t after) const {
  const std::lock_guard lock(mutex_);
  Reading reading{.frames = {}, .last_seq = after, .end = false};
  if (after < forgotten_ && !ring_.empty()) {
    reading.last_seq = forgotten_;
    reading.frames = api::sse_frame(api::gap_event(after + 1, reading.last_seq));
  }
  for (auto next = std::ranges::upper_bound(ring_, reading.last_seq, {}, &Frame::seq);
       next != ring_.end(); ++next) {
    if (reading.frames.size() > kMaxReadingBytes) return reading;
    reading.frames += next->text;
    reading.last_seq = next->seq;
  }
  reading.end = over();
  return reading;
}

bool JobFeed::wait_finished(std::chrono::steady_clock::time_point until) const {
  std::unique_lock lock(mutex_);
  over_.wait_until(lock, until, [&] { return over(); });
  return finished_;
}

void EventFeed::share_with(std::function<void(store::EventRow event)> share,
                           std::function<void(const std::string& job)> found) {
  share_ = std::move(share);
  found_ = std::move(found);
}

/// Requires the mutex.
std::shared_ptr<JobFeed> EventFeed::make(const std::string& job, int attempt,
                                         std::chrono::milliseconds waited) {
  JobFeed::Share share;
  if (share_)
    share = [this, job](store::EventRow event) {
      event.job = job;
      share_(std::move(event));
    };
  auto feed = std::make_shared<JobFeed>(attempt * kSeqsPerAttempt, ring_, metrics_, news_,
                                        std::move(share), waited);
  feeds_[job] = feed;
  return feed;
}

std::shared_ptr<JobFeed> EventFeed::open(const std::string& job, int attempt,
                                         std::chrono::milliseconds waited) {
  const std::lock_guard lock(mutex_);
  return make(job, attempt, waited);
}

std::shared_ptr<JobFeed> EventFeed::find(std::string_view job) const {
  const std::lock_guard lock(mutex_);
  const auto found = feeds_.find(job);
  return found == feeds_.end() ? nullptr : found->second;
}

std::shared_ptr<JobFeed> EventFeed::find_or_follow(const store::JobRecord& job) {
  std::shared_ptr<JobFeed> feed;
  bool is_new = false;
  {
    const std::lock_guard lock(mutex_);
    const auto found = feeds_.find(job.id);
    is_new = found == feeds_.end();
    if (!is_new && !found->second->is_following()) return found->second;
    if (is_new && (!share_ || api::is_final(job.state))) return nullptr;
    feed = is_new ? make(job.id, 0) : found->second;
    if (is_new) feed->follow(true);
  }
  if (is_new) found_(job.id);
  feed->wait_caught_up(kTimeToCatchUp);
  return feed;
}

std::vector<std::pair<std::string, std::shared_ptr<JobFeed>>> EventFeed::following() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<std::string, std::shared_ptr<JobFeed>>> found;
  for (const auto& [job, feed] : feeds_)
    if (feed->is_following() && !feed->is_finished()) found.emplace_back(job, feed);
  return found;
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
