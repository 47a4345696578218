#pragma once

#include <gtest/gtest.h>

#include <exception>
#include <string>

#include "server/base/errors.hpp"

namespace unwrapd::server {

/// What the operator reads of the failure.
template <class Action>
std::string reason_for(const Action& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return reason_of(error);
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

}  // namespace unwrapd::server
