// SPDX-License-Identifier: MIT
// Without cpp-httplib nothing is served.
#include "cost/serving_cost.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::cost {

ServingCost count_serving(std::size_t /*clients*/) {
  throw SetupError(Fault{"serve", "this program was made without cpp-httplib"});
}

}  // namespace seqloop::cost
