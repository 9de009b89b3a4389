#include "seqloop/arena.hpp"

#include <cstdint>
#include <string>

#include "seqloop/fault.hpp"

namespace seqloop {

ArenaMemory::ArenaMemory(std::size_t bytes, std::span<std::byte> memory) : span_(memory) {
  if (!memory.empty()) {
    if (memory.size() < bytes) {
      throw SetupError(
          {"memory",
           std::to_string(memory.size()) + " bytes given, " + std::to_string(bytes) + " needed",
           "ask bytes_needed() for the size"});
    }
    if (reinterpret_cast<std::uintptr_t>(memory.data()) % Arena::alignment != 0) {
      throw SetupError({"memory", "not aligned to " + std::to_string(Arena::alignment) + " bytes"});
    }
    return;
  }
  void* taken = ::operator new (bytes, std::align_val_t{Arena::alignment}, std::nothrow);
  if (taken == nullptr) {
    throw SetupError({"memory", std::to_string(bytes) + " bytes are not to be had",
                      "lower the capacity; `plan` shows what each buffer takes"});
  }
  own_.reset(static_cast<std::byte*>(taken));
  span_ = {own_.get(), bytes};
}

}  // namespace seqloop
