// Jobs whose question has been answered before: they get that answer, with its notes, from the
// store.
#include "api/report.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/work/lambda_selection.hpp"

namespace unwrapd::server::jobs {

/// Shares the files of the answer with this job if all of them match their digests, and counts
/// them. Reads all of them.
std::optional<JobQueue::Answer> JobQueue::find_answer(store::JobRecord& job) {
  const std::optional<store::JobRecord> same = store_.find_same(job.owner, job.content_key);
  if (!same || !same->unreadable.empty()) return std::nullopt;
  std::optional<Answer> answer = adopt_answer(job.id, *same);
  if (answer) job.stored_bytes = blobs_.bytes(job.id);
  return answer;
}

std::optional<JobQueue::Answer> JobQueue::adopt_answer(const std::string& id,
                                                       const store::JobRecord& same) {
  try {
    const std::string report = blobs_.read(same.id, work::map_file(blobs::kReportFile, 0));
    Answer answer{.format = same.result_format, .notes = api::notes_of_report(report)};
    if (blobs_.adopt(id, same.id)) return answer;
  } catch (const Error& error) {  // its report is gone or damaged: the job is run like any other
    log_.warning("stored answer not used", {{"job", same.id}, {"reason", error.what()}});
  }
  return std::nullopt;
}

bool JobQueue::answer_from_store(const store::JobRecord& job, const Answer& answer) {
  const std::shared_ptr<JobFeed> feed = events_.open(job.id, job.attempt);
  for (const Note& note : answer.notes)
    feed->publish([&](std::int64_t seq) { return api::note_event(seq, note); });
  try {
    end_job(job, {.result_format = answer.format, .problem = {}, .stored_bytes = job.stored_bytes});
    return true;
  } catch (const Error&) {  // the job is stored and waits, as it would without the answer
    feed->end();
    events_.forget(job.id);
    return false;
  }
}

}  // namespace unwrapd::server::jobs
