#include "server/jobs/work_sharing.hpp"

#include <set>
#include <string>
#include <thread>
#include <utility>

#include "core/base/error.hpp"
#include "server/base/errors.hpp"

namespace unwrapd::server::jobs {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kPauseBetweenBundles{20};
constexpr std::size_t kMostFailed = 64;

[[noreturn]] void help_no_longer() {
  throw Error(ErrorCode::cancelled, "This job is helped no longer.");
}

}  // namespace

class WorkSharing::Desk final : public work::WorkDesk {
 public:
  Desk(WorkSharing& sharing, const store::JobRecord& job, bool is_helper, std::stop_token stop)
      : sharing_(sharing), job_(job), is_helper_(is_helper), stop_(std::move(stop)) {}
  Desk(const Desk&) = delete;
  Desk& operator=(const Desk&) = delete;
  ~Desk() override {
    if (!seen_.empty() && !is_helper_) sharing_.drop(job_);
  }

  std::optional<Claim> claim(std::string_view stage, int bundles) override {
    check_help();
    return tried<Claim>([&]() -> std::optional<Claim> {
      const store::StageOfJob of = stage_of(stage);
      sharing_.store_.open_stage(of, bundles);
      if (seen_.insert(of.stage).second && !is_helper_) {
        sharing_.counts_.offered += static_cast<std::uint64_t>(bundles);
        sharing_.tell_();
      }
      const std::optional<int> bundle = sharing_.store_.claim_bundle(of, is_helper_);
      if (!bundle) return std::nullopt;
      Claim claim{.bundle = *bundle};
      if (job_.attempt > 1) claim.made = sharing_.store_.bundle(of, *bundle);
      if (claim.made && !is_helper_) ++sharing_.counts_.found;
      return claim;
    });
  }

  void publish(std::string_view stage, int bundle, std::string_view bytes) override {
    tried<bool>([&]() -> std::optional<bool> {
      sharing_.store_.keep_bundle(stage_of(stage), bundle, bytes);
      if (is_helper_) ++sharing_.counts_.helped;
      return true;
    });
  }

  std::optional<std::string> obtain(std::string_view stage, int bundle,
                                    milliseconds patience) override {
    const store::StageOfJob of = stage_of(stage);
    for (const auto until = Clock::now() + patience; !stop_.stop_requested();) {
      auto bytes = tried<std::string>([&] { return sharing_.store_.bundle(of, bundle); });
      if (bytes && !is_helper_) ++sharing_.counts_.found;
      if (bytes) return bytes;
      check_help();
      if (!is_helper_ && Clock::now() >= until) break;
      std::this_thread::sleep_for(kPauseBetweenBundles);
    }
    if (!is_helper_) ++sharing_.counts_.lost;
    return std::nullopt;
  }

 private:
  [[nodiscard]] store::StageOfJob stage_of(std::string_view stage) const {
    return {.job = job_.seq, .attempt = job_.attempt, .stage = std::string(stage)};
  }

  /// A helper leaves when its job has ended, and for jobs that wait.
  void check_help() {
    if (!is_helper_) return;
    const auto may_stay = tried<bool>([&]() -> std::optional<bool> {
      return !sharing_.is_any_waiting() && sharing_.store_.is_running(job_.seq, job_.attempt);
    });
    if (stop_.stop_requested() || !may_stay.value_or(false)) help_no_longer();
  }

  /// What the store answers; nothing where it fails, so that the job goes on alone.
  template <class Value, class Ask>
  std::optional<Value> tried(const Ask& ask) {
    try {
      return ask();
    } catch (const std::exception& error) {
      if (!std::exchange(has_warned_, true))
        sharing_.log_.warning("the work of a job is not shared",
                              {{"job", job_.id}, {"reason", reason_of(error)}});
      return std::nullopt;
    }
  }

  WorkSharing& sharing_;
  const store::JobRecord job_;
  const bool is_helper_;
  const std::stop_token stop_;
  std::set<std::string> seen_;  ///< stages
  bool has_warned_ = false;
};

std::shared_ptr<HelpedJob> WorkSharing::find() {
  const std::lock_guard lock(mutex_);
  if (is_closed_) return nullptr;
  std::optional<store::JobRecord> job = store_.job_to_help(failed_);
  if (!job) return nullptr;
  auto helped = std::make_shared<HelpedJob>();
  helped->record = std::move(*job);
  std::erase_if(helped_, [](const auto& old) { return old.expired(); });
  helped_.push_back(helped);
  return helped;
}

bool WorkSharing::is_running(const HelpedJob& helped) {
  return store_.is_running(helped.record.seq, helped.record.attempt);
}

bool WorkSharing::is_any_waiting() { return store_.counts().waiting > 0; }

void WorkSharing::leave(const HelpedJob& helped, bool failed) {
  const auto took = std::chrono::duration_cast<milliseconds>(Clock::now() - helped.began).count();
  try {
    store_.charge(helped.record.owner, took);
  } catch (const std::exception& error) {
    log_.warning("the help with a job was not counted",
                 {{"job", helped.record.id}, {"reason", reason_of(error)}});
  }
  const std::lock_guard lock(mutex_);
  if (!failed) return;
  if (failed_.size() == kMostFailed) failed_.erase(failed_.begin());
  failed_.push_back(helped.record.seq);
}

void WorkSharing::close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  for (const std::weak_ptr<HelpedJob>& each : helped_)
    if (const std::shared_ptr<HelpedJob> helped = each.lock()) helped->stop.request_stop();
}

std::unique_ptr<work::WorkDesk> WorkSharing::desk_of_job(const store::JobRecord& job,
                                                         std::stop_token stop) {
  return std::make_unique<Desk>(*this, job, false, std::move(stop));
}

std::unique_ptr<work::WorkDesk> WorkSharing::desk_of_helper(const HelpedJob& helped) {
  return std::make_unique<Desk>(*this, helped.record, true, helped.stop.get_token());
}

void WorkSharing::drop(const store::JobRecord& job) {
  try {
    store_.drop_shared_work(job.seq);
  } catch (const std::exception& error) {  // a later sweep finds it
    log_.warning("the shared work of a job was not dropped",
                 {{"job", job.id}, {"reason", reason_of(error)}});
  }
}

}  // namespace unwrapd::server::jobs
