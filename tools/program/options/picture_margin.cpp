// SPDX-License-Identifier: MIT
#include "program/options/picture_margin.hpp"

#include <algorithm>

namespace seqloop::program {

PictureNeeds with_margin(const PictureNeeds& needs) {
  constexpr int margin = 2;
  constexpr int enough_width = 640;
  constexpr int enough_height = 480;
  return {std::max(needs.width, std::min(margin * needs.width, enough_width)),
          std::max(needs.height, std::min(margin * needs.height, enough_height)),
          needs.gray_is_enough};
}

}  // namespace seqloop::program
