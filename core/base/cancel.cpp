#include "core/base/cancel.hpp"

#include "core/base/error.hpp"

namespace unwrapd {

bool is_cancelled(const std::stop_token& stop) { return stop.stop_requested(); }

void throw_if_cancelled(const std::stop_token& stop) {
  if (is_cancelled(stop)) throw Error(ErrorCode::cancelled, "the job was cancelled");
}

}  // namespace unwrapd
