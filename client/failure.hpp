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
  Failure(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}

  [[nodiscard]] ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

}  // namespace unwrapd::client
