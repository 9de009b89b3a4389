// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "bags/byte_source.hpp"
#include "seqloop/bags/bag.hpp"

namespace seqloop::bags {

/// Opens what an MCAP file holds. @param name of it, for messages
/// Throws SetupError: no MCAP file.
[[nodiscard]] std::unique_ptr<Bag> open_mcap(std::unique_ptr<ByteSource> bytes,
                                             const std::string& name);

}  // namespace seqloop::bags
