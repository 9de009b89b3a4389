// SPDX-License-Identifier: MIT
#pragma once

namespace seqloop {

/// What a describer makes of pictures, so that who decodes them does no more than that. Any picture
/// can be described all the same.
struct PictureNeeds {
  int width = 0;   ///< pixels to which pictures are brought; 0: they are taken as they come
  int height = 0;  ///< likewise
  bool gray_is_enough = false;  ///< colour becomes grey first
};

}  // namespace seqloop
