#include "server/jobs/feed_output.hpp"

#include <chrono>
#include <thread>

#include "api/events.hpp"
#include "server/base/errors.hpp"

namespace unwrapd::server::jobs {
namespace {

constexpr double kStep = 0.005;  // of the fraction
constexpr std::chrono::milliseconds kPauseForStore{200};

bool is_news(const StageEvent& event, const StageEvent& told) {
  return event.stage != told.stage || event.chart != told.chart ||
         event.chart_count != told.chart_count || event.lambda != told.lambda ||
         event.fraction >= told.fraction + kStep;
}

}  // namespace

FeedOutput::FeedOutput(const RunningJob& job, blobs::BlobStore& blobs, ResultClaim room)
    : job_(job), blobs_(blobs), room_(room) {
  const std::lock_guard lock(job_.output);
  if (!job_.has_ended) room_.reservation.give_up();
}

void FeedOutput::stage(const StageEvent& event) {
  const std::lock_guard lock(job_.output);
  if (job_.has_ended) return;
  job_.feed->set_progress({.stage = event.stage,
                           .fraction = event.fraction,
                           .chart = event.chart,
                           .iteration = 0,
                           .energy = 0});
  if (told_ && !is_news(event, *told_)) return;
  told_ = event;
  job_.feed->publish([&](std::int64_t seq) { return api::stage_event(seq, event); });
}

void FeedOutput::iteration(const IterationEvent& event, double elapsed_ms) {
  const std::lock_guard lock(job_.output);
  if (job_.has_ended) return;
  job_.feed->set_progress({.stage = Stage::solve,
                           .fraction = event.fraction,
                           .chart = event.chart,
                           .iteration = event.iteration,
                           .energy = event.energy});
  job_.feed->publish(
      [&](std::int64_t seq) { return api::iteration_event(seq, event, elapsed_ms); });
}

void FeedOutput::note(const Note& note) {
  const std::lock_guard lock(job_.output);
  if (job_.has_ended) return;
  job_.feed->publish([&](std::int64_t seq) { return api::note_event(seq, note); });
}

void FeedOutput::result(std::string_view format, std::string_view bytes) {
  keep(blobs::result_file(format), bytes);
}

void FeedOutput::file(std::string_view name, std::string_view bytes) { keep(name, bytes); }

void FeedOutput::keep(std::string_view name, std::string_view bytes) {
  while (!try_keep(name, bytes)) std::this_thread::sleep_for(kPauseForStore);
}

/// False when the store cannot say whether there is room for it.
bool FeedOutput::try_keep(std::string_view name, std::string_view bytes) {
  const std::lock_guard lock(job_.output);
  if (job_.has_ended) throw Error(ErrorCode::cancelled, "The job was given up in the meantime.");
  try {
    room_.reservation.add(static_cast<std::int64_t>(bytes.size()),
                          room_.most_bytes(job_.record.owner));
  } catch (const StoreAway&) {
    if (!job_.stop.stop_requested()) return false;
    throw Error(ErrorCode::cancelled, "The job was stopped before its files could be counted.");
  }
  blobs_.write_unsealed(job_.record.id, job_.record.attempt, name, bytes);
  return true;
}

}  // namespace unwrapd::server::jobs
