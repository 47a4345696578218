#pragma once
// Errors with two texts: one for the client, and the reason for the operator's log, which may name
// files and quote libraries.

#include <exception>
#include <string>
#include <utility>

#include "core/base/error.hpp"

namespace unwrapd::server {

class InsideError : public Error {
 public:
  InsideError(ErrorCode code, const std::string& told, std::string reason)
      : Error(code, told), reason_(std::move(reason)) {}

  [[nodiscard]] const std::string& reason() const noexcept { return reason_; }

 private:
  std::string reason_;
};

/// What the log says of an error.
inline std::string reason_of(const std::exception& error) {
  const auto* inside = dynamic_cast<const InsideError*>(&error);
  return inside != nullptr ? inside->reason() : error.what();
}

}  // namespace unwrapd::server
