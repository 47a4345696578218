#pragma once
// What a call fails with.

#include <gtest/gtest.h>

#include <string>

#include "client/failure.hpp"

namespace unwrapd::client {

/// Runs the call, expects a Failure of this code and returns its message.
template <class Call>
std::string expect_failure(ExitCode code, Call&& call) {
  try {
    call();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), code) << failure.what();
    return failure.what();
  }
  ADD_FAILURE() << "nothing failed";
  return {};
}

}  // namespace unwrapd::client
