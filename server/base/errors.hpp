#pragma once
// Errors of the server: those that tell a client when to come back, those that tell the operator
// more than the client, and the answers of the queue.

#include <cstdint>
#include <exception>
#include <string>
#include <utility>

#include "core/base/error.hpp"

namespace unwrapd::server {

/// A refusal that passes: the answer carries Retry-After.
class RetryLater : public Error {
 public:
  RetryLater(ErrorCode code, const std::string& message, int seconds)
      : Error(code, message), seconds_(seconds) {}
  [[nodiscard]] int seconds() const { return seconds_; }

 private:
  int seconds_;
};

/// What of the store may be away.
enum class StorePart { database, files };

/// A part of the store cannot be reached, which passes. reason: for the log of the operator.
class StoreAway : public RetryLater {
 public:
  StoreAway(StorePart part, const std::string& reason, bool in_doubt = false);

  [[nodiscard]] const std::string& reason() const noexcept { return reason_; }
  /// The same without the part: "it answers GET with 403".
  [[nodiscard]] const std::string& detail() const noexcept { return detail_; }
  /// Whether the change may yet have come about.
  [[nodiscard]] bool in_doubt() const { return in_doubt_; }

 private:
  std::string detail_;
  std::string reason_;
  bool in_doubt_;
};

/// An error with two texts: one for the client, and the reason for the log of the operator, which
/// may name files and quote libraries.
class InsideError : public Error {
 public:
  InsideError(ErrorCode code, const std::string& told, std::string reason)
      : Error(code, told), reason_(std::move(reason)) {}

  [[nodiscard]] const std::string& reason() const noexcept { return reason_; }

 private:
  std::string reason_;
};

/// Throws Error{invalid_option} whose place is the option, parameter or member of this name.
[[noreturn]] void refuse_option(const std::string& name, const std::string& what);

/// What the log says of an error; where a limit of this process is too small, which one to raise.
std::string reason_of(const std::exception& error);

// The queue refuses a job, or gives one up.
RetryLater draining();
RetryLater shutting_down();  ///< of /readyz
RetryLater no_room(int seconds);
RetryLater queue_full(int places, int seconds);
RetryLater too_many_jobs(std::int64_t most, int seconds);
Error quota_exceeded(std::int64_t most_bytes);
Error unknown_job();
Error another_question();
Error cancelled_by_owner();
Error job_stopped();
Error unreadable_job();
Error poison();
Error too_many_crashes();  ///< of the process of one job

/// An upload ticket takes one job.
Error ticket_spent();

}  // namespace unwrapd::server
