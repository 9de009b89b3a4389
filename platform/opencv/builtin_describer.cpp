// SPDX-License-Identifier: MIT
#include "seqloop/opencv/builtin_describer.hpp"

#include "opencv/detail/builtin_model.hpp"

namespace seqloop::opencv {

std::unique_ptr<DnnDescriber> make_builtin_describer() {
  ModelSettings settings;
  settings.model = "built-in descriptor";
  return std::make_unique<DnnDescriber>(builtin_model(), settings);
}

}  // namespace seqloop::opencv
