#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "engine/base/error.h"

namespace touchtrace::testing {

/// Expects that `action` throws an Error that has a hint, `text` in its message or hint, and this
/// code unless it is empty. Returns the message.
template <class Action>
std::string expect_error(const Action& action, const std::string& text,
                         std::optional<ExitCode> code = ExitCode::data) {
  try {
    action();
  } catch (const Error& error) {
    const std::string found = std::string(error.what()) + "; " + error.hint();
    EXPECT_EQ(error.code(), code.value_or(error.code())) << found;
    EXPECT_FALSE(error.hint().empty()) << found;
    EXPECT_NE(found.find(text), std::string::npos) << "no '" << text << "' in: " << found;
    return error.what();
  }
  ADD_FAILURE() << "accepted, instead of '" << text << "'";
  return {};
}

/// Expects that `action`, which reads damaged bytes, succeeds or throws a data_error.
template <class Action>
void expect_read_or_refused(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data) << error.what();
  }
}

}  // namespace touchtrace::testing
