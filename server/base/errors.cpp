#include "server/base/errors.hpp"

#include <new>
#include <system_error>

#include "api/json.hpp"
#include "server/base/files.hpp"

namespace unwrapd::server {
namespace {

constexpr int kDrainRetrySeconds = 5;
constexpr int kAwayRetrySeconds = 2;

}  // namespace

StoreAway::StoreAway(StorePart part, const std::string& reason, bool in_doubt)
    : RetryLater(ErrorCode::storage_failed,
                 "The server's " +
                     std::string(part == StorePart::database ? "database" : "storage") +
                     " cannot be reached; send the request again after Retry-After.",
                 kAwayRetrySeconds),
      detail_(reason),
      reason_((part == StorePart::database ? "The database of --database cannot be reached ("
                                           : "The bucket of --blobs cannot be reached (") +
              reason + ")."),
      in_doubt_(in_doubt) {}

void refuse_option(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::invalid_option, what, "/" + api::pointer_token(name));
}

std::string reason_of(const std::exception& error) {
  if (const auto* inside = dynamic_cast<const InsideError*>(&error)) return inside->reason();
  if (const auto* away = dynamic_cast<const StoreAway*>(&error)) return away->reason();
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr)
    return "There is too little memory; raise its limit (ulimit -v, MemoryMax).";
  const auto* refused = dynamic_cast<const std::system_error*>(&error);
  if (refused != nullptr && refused->code() == std::errc::resource_unavailable_try_again)
    return "A thread could not be started; raise the limit of address space (ulimit -v) or of "
           "threads (ulimit -u, TasksMax, pids.max).";
  return error.what();
}

RetryLater draining() {
  return {ErrorCode::draining,
          "The server is shutting down and takes no new jobs; send it again shortly.",
          kDrainRetrySeconds};
}

RetryLater shutting_down() {
  return {ErrorCode::draining, "The server is shutting down; use another server.", 1};
}

RetryLater no_room(int seconds) {
  return {ErrorCode::storage_full, std::string(kStorageFull), seconds};
}

RetryLater queue_full(int places, int seconds) {
  return {ErrorCode::queue_full,
          "All " + std::to_string(places) +
              " places in the queue are taken; send the job again after Retry-After.",
          seconds};
}

RetryLater too_many_jobs(std::int64_t most, int seconds) {
  return {ErrorCode::too_many_jobs,
          "This API key may have " + std::to_string(most) +
              " jobs waiting or running; send the job again when one has ended.",
          seconds};
}

Error quota_exceeded(std::int64_t most_bytes) {
  return {ErrorCode::quota_exceeded, "The jobs of this API key may take " +
                                         std::to_string(most_bytes) +
                                         " bytes; remove finished jobs, then send this one again."};
}

Error unknown_job() {
  return {ErrorCode::not_found, "There is no job of this id; check the address."};
}

Error another_question() {
  return {ErrorCode::idempotency_conflict,
          "This name belongs to a request with another mesh or other options; use a new name."};
}

Error cancelled_by_owner() {
  return {ErrorCode::cancelled, "The job was cancelled; send it again to run it."};
}

Error job_stopped() {
  return {ErrorCode::cancelled, "The job was stopped; send it again to run it."};
}

Error unreadable_job() {
  return {ErrorCode::storage_corrupt,
          "The stored data of this job cannot be read; send the job again."};
}

Error poison() {
  return {ErrorCode::poison,
          "The server ended several times while this job ran, so the job is not tried again. Check "
          "the mesh, or send a smaller part of it."};
}

Error too_many_crashes() {
  return {ErrorCode::poison,
          "The process of this job ended three times while the job ran, so the job is not tried "
          "again. Check the mesh, or send a smaller part of it."};
}

Error ticket_spent() {
  return Error(ErrorCode::invalid_link, "The upload ticket was used; ask for a new one.");
}

}  // namespace unwrapd::server
