#pragma once
// The reason why the command ends without a result: an exit code and a sentence. It is thrown where
// the cause is known, and caught in main() alone.

#include <stdexcept>
#include <string>

namespace unwrapd::client {

enum class ExitCode {
  ok = 0,
  job_failed = 1,   ///< the server refused or failed the job; its problem is printed
  usage = 2,        ///< the command line is invalid
  unreachable = 3,  ///< no server, no answer in time, or an answer that is not from unwrapd
  file = 4,         ///< a file that cannot be read or written
  interrupted = 130,
};

class Failure : public std::runtime_error {
 public:
  Failure(ExitCode code, const std::string& message, bool may_pass = false)
      : std::runtime_error(message), code_(code), may_pass_(may_pass) {}

  [[nodiscard]] ExitCode code() const noexcept { return code_; }
  /// Whether the same call may succeed a little later: a server that gave no answer.
  [[nodiscard]] bool may_pass() const noexcept { return may_pass_; }

 private:
  ExitCode code_;
  bool may_pass_;
};

}  // namespace unwrapd::client
