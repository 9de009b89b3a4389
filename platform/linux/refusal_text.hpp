#pragma once

#include <string>

#include "linux/system_calls.hpp"
#include "linux/video_node.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::live {

/// Tells a person why a camera cannot be opened and what to do; looks around for that: who holds
/// it, which group owns it, which other nodes there are. Allocates: yes.
[[nodiscard]] Fault explain(SystemCalls& system, const std::string& path, const Refusal& refusal);

/// The same in few words, for a camera that is being looked for.
[[nodiscard]] std::string brief(const Refusal& refusal);

}  // namespace seqloop::live
