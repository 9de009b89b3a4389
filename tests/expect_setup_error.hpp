// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "seqloop/fault.hpp"

namespace seqloop::test {

/// The message of the SetupError that the call throws; empty, and a failed test, when it throws
/// none.
template <typename Call>
std::string setup_error(Call call) {
  try {
    call();
  } catch (const SetupError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no SetupError";
  return {};
}

/// Whether a message says something.
inline ::testing::AssertionResult says(const std::string& message, const std::string& part) {
  if (message.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << message << "' does not say '" << part << "'";
}

}  // namespace seqloop::test
