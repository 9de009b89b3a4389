// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace seqloop::program {

/// The page's files, compiled in (`watch/page`).
struct PageFiles {
  std::string_view html;
  std::string_view style;
  std::string_view script;
};
[[nodiscard]] PageFiles page_files() noexcept;

}  // namespace seqloop::program
