#pragma once
// The error that a call throws, for tests that look at its code, message and place.

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace unwrapd {

/// The Error that action throws; fails the test when it throws none.
template <class Action>
Error error_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "no Error was thrown";
  return {ErrorCode::internal, "no Error was thrown"};
}

}  // namespace unwrapd
