// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "seqloop/fault.hpp"
#include "seqloop/linux/detail/video_node.hpp"
#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// Tells a person why a camera cannot be opened and what to do; looks around for that: who holds
/// it, which group owns it, which other nodes there are. Allocates: yes.
[[nodiscard]] Fault explain(SystemCalls& system, const std::string& path, const Refusal& refusal);

/// The same in few words, for a camera that is being looked for.
[[nodiscard]] std::string brief(const Refusal& refusal);

}  // namespace seqloop::live
