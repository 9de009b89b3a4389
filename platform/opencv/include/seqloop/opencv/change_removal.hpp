// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "seqloop/describer.hpp"
#include "seqloop/frame_source.hpp"
#include "seqloop/opencv/dnn_describer.hpp"

namespace seqloop::opencv {

/// Change Removal (Lowry & Milford): a net that sees pictures less their projection on the first
/// principal components of a training drive, which hold what changes most from picture to picture
/// there: light, weather, season.
///
/// Pictures are brought to the net's input size and channels as the net itself does it, lose their
/// components there, are rounded to bytes, and become `(pixel - mean) * scale` inside the net.
class ChangeRemoval : public Describer {
 public:
  /// Learns. P below are the bytes of the net's input: width * height, times 3 unless it is grey.
  /// @param net        described with
  /// @param training   drives, read to their ends; what cannot be read is left out; at least
  ///   components + 1 pictures in all, at most 1,000
  /// @param components m to remove; 0 removes nothing
  /// @param between    called before each picture and while components are computed; what it throws
  ///   ends the learning
  /// Throws SetupError: too few or too many pictures.
  /// Work and allocations: PrincipalComponents', of N pictures of P bytes, and the N P bytes of the
  /// pictures while it learns.
  ChangeRemoval(std::unique_ptr<DnnDescriber> net, std::span<FrameSource* const> training,
                std::size_t components, const std::function<void()>& between = {});
  ChangeRemoval(const ChangeRemoval&) = delete;
  ChangeRemoval& operator=(const ChangeRemoval&) = delete;
  ChangeRemoval(ChangeRemoval&&) = delete;
  ChangeRemoval& operator=(ChangeRemoval&&) = delete;
  ~ChangeRemoval() override;

  /// The net's.
  [[nodiscard]] std::size_t size() const noexcept override;

  /// The net's.
  [[nodiscard]] PictureNeeds needs() const noexcept override;

  /// As the net says. Work: the net's and 2 m P MACs. Allocates: what the net does.
  [[nodiscard]] Description describe(const Image& image,
                                     std::span<float> descriptor) noexcept override;

  [[nodiscard]] std::string_view last_fault() const noexcept override;

  /// Components removed: fewer than asked for when the training pictures vary in fewer directions.
  [[nodiscard]] std::size_t components() const noexcept;

  /// What the net was shown last; valid until the next call.
  [[nodiscard]] Image last_picture() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::opencv
