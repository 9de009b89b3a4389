// SPDX-License-Identifier: MIT
#include "seqloop/detail/arena.hpp"

#include <cstdint>
#include <string>
#include <utility>

#include "seqloop/fault.hpp"

namespace seqloop {

ArenaMemory::ArenaMemory(std::uint64_t bytes, std::span<std::byte> memory) : span_(memory) {
  if (!memory.empty()) {
    Faults faults;
    if (memory.size() < bytes) {
      faults.push_back(
          {"memory",
           std::to_string(memory.size()) + " bytes given, " + std::to_string(bytes) + " needed",
           "ask bytes_needed() for the size"});
    }
    if (reinterpret_cast<std::uintptr_t>(memory.data()) % Arena::alignment != 0) {
      faults.push_back({"memory", "not aligned to " + std::to_string(Arena::alignment) + " bytes",
                        "begin it at a multiple of Arena::alignment"});
    }
    if (!faults.empty()) throw SetupError(std::move(faults));
    return;
  }
  const auto all = static_cast<std::size_t>(bytes);
  void* taken = all == bytes
                    ? ::operator new (all, std::align_val_t{Arena::alignment}, std::nothrow)
                    : nullptr;
  if (taken == nullptr) {
    throw SetupError({"memory", std::to_string(bytes) + " bytes are not to be had",
                      "lower the capacity; `plan` shows what each buffer takes"});
  }
  own_.reset(static_cast<std::byte*>(taken));
  span_ = {own_.get(), all};
}

}  // namespace seqloop
