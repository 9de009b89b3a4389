// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace seqloop::program {

/// JSON as text. Names of files, sessions and robots may be no UTF-8: what is none becomes U+FFFD.
/// @param indent columns; -1: all in one line
template <class Json>
[[nodiscard]] std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace seqloop::program
