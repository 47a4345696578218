#pragma once
// A refusal that passes: the answer carries Retry-After.

#include <string>

#include "core/base/error.hpp"

namespace unwrapd::server {

class RetryLater : public Error {
 public:
  RetryLater(ErrorCode code, const std::string& message, int seconds)
      : Error(code, message), seconds_(seconds) {}
  [[nodiscard]] int seconds() const { return seconds_; }

 private:
  int seconds_;
};

}  // namespace unwrapd::server
