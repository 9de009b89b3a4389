// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/oracle.hpp"
#include "platform/linux/fake_camera.hpp"
#include "seqloop/describer.hpp"
#include "seqloop/frame_source.hpp"
#include "seqloop/pipeline.hpp"

namespace seqloop::live::test {

/// Describes a fake camera's picture by the row of a synthetic drive that its index stands for.
class FakeDescriber : public Describer {
 public:
  explicit FakeDescriber(oracle::Vectors drive) : drive_(std::move(drive)) {}
  [[nodiscard]] std::size_t size() const noexcept override { return drive_.front().size(); }
  [[nodiscard]] Description describe(const Image& image,
                                     std::span<float> descriptor) noexcept override {
    const std::uint64_t index = index_in(image.data);
    if (index == always) return Description::failed;
    std::ranges::copy(drive_[static_cast<std::size_t>(index % drive_.size())], descriptor.begin());
    return Description::good;
  }
  [[nodiscard]] std::string_view last_fault() const noexcept override { return "torn"; }

 private:
  oracle::Vectors drive_;
};

inline Pipeline pipeline_of(FrameSource& source, Describer& describer, Detector& detector,
                            Clock& clock) {
  return {source, &describer, detector, clock, describer.size()};
}

}  // namespace seqloop::live::test
