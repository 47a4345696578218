#pragma once
// Why the command ends without a result, as an exit code and a sentence. Thrown where the cause is
// known, caught in main() alone.

#include <stdexcept>
#include <string>

namespace unwrapd::client {

enum class ExitCode {
  ok = 0,
  job_failed = 1,   ///< the server refused or failed the job; its problem is printed
  usage = 2,        ///< the command line makes no sense
  unreachable = 3,  ///< no server, no answer in time, or an answer that is not unwrapd's
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
