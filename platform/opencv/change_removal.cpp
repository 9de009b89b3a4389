// SPDX-License-Identifier: MIT
#include "seqloop/opencv/change_removal.hpp"

#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "opencv/detail/guarded.hpp"
#include "opencv/detail/picture_scaler.hpp"
#include "opencv/detail/training.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/fault.hpp"
#include "seqloop/principal_components.hpp"

namespace seqloop::opencv {
namespace {

/// Brings pictures to a net's input size and channels.
class NetPicture {
 public:
  explicit NetPicture(const DnnDescriber& net)
      : scaler_({net.input_width(), net.input_height()}, net.gray()),
        picture_(net.input_height(), net.input_width(), net.gray() ? CV_8UC1 : CV_8UC3) {}

  /// May throw cv::Exception.
  void fill(const Image& image) {
    const cv::Mat scaled = scaler_.scale(image);
    if (scaled.channels() == picture_.channels()) {
      scaled.copyTo(picture_);
    } else {
      cv::cvtColor(scaled, picture_, cv::COLOR_GRAY2BGR);
    }
  }

  [[nodiscard]] std::span<std::uint8_t> bytes() {
    return {picture_.data, picture_.total() * picture_.elemSize()};
  }
  [[nodiscard]] const cv::Mat& mat() const noexcept { return picture_; }

 private:
  PictureScaler scaler_;
  cv::Mat picture_;
};

PrincipalComponents learn(NetPicture& picture, std::span<FrameSource* const> training,
                          std::size_t components, const std::function<void()>& between) {
  std::vector<std::uint8_t> pictures;
  const std::size_t size = picture.bytes().size();
  const TrainingCount count = for_each_picture(training, [&](const Image& image) {
    if (between) between();
    if (pictures.size() == PrincipalComponents::most_pictures * size) {
      throw SetupError(
          Fault{"training",
                "has more than " + std::to_string(PrincipalComponents::most_pictures) + " pictures",
                "give shorter drives"});
    }
    picture.fill(image);
    pictures.insert(pictures.end(), picture.bytes().begin(), picture.bytes().end());
  });
  if (count.pictures < components + 1) {
    throw SetupError(
        Fault{"training",
              "has " + text(count) + ", too few to remove " + counted(components, "component"),
              "give longer drives, or remove at least one component fewer than there "
              "are pictures"});
  }
  return {pictures, size, components, between};
}

}  // namespace

class ChangeRemoval::Impl {
 public:
  Impl(std::unique_ptr<DnnDescriber> net, std::span<FrameSource* const> training,
       std::size_t components, const std::function<void()>& between)
      : net_(std::move(net)),
        picture_(*net_),
        components_(learn(picture_, training, components, between)) {}

  /// May throw.
  [[nodiscard]] Description describe(const Image& image, std::span<float> descriptor) {
    picture_.fill(image);
    components_.remove(picture_.bytes(), picture_.bytes());
    const Description description = net_->describe(view(picture_.mat()), descriptor);
    if (description == Description::failed) fault_ = net_->last_fault();
    return description;
  }

  [[nodiscard]] std::size_t size() const noexcept { return net_->size(); }
  [[nodiscard]] PictureNeeds needs() const noexcept { return net_->needs(); }
  [[nodiscard]] std::size_t components() const noexcept { return components_.count(); }
  [[nodiscard]] const cv::Mat& picture() const noexcept { return picture_.mat(); }
  [[nodiscard]] std::string& fault() noexcept { return fault_; }

 private:
  std::unique_ptr<DnnDescriber> net_;
  NetPicture picture_;
  PrincipalComponents components_;
  std::string fault_;
};

ChangeRemoval::ChangeRemoval(std::unique_ptr<DnnDescriber> net,
                             std::span<FrameSource* const> training, std::size_t components,
                             const std::function<void()>& between)
    : impl_(std::make_unique<Impl>(std::move(net), training, components, between)) {}

ChangeRemoval::~ChangeRemoval() = default;

std::size_t ChangeRemoval::size() const noexcept { return impl_->size(); }

PictureNeeds ChangeRemoval::needs() const noexcept { return impl_->needs(); }

Description ChangeRemoval::describe(const Image& image, std::span<float> descriptor) noexcept {
  return guarded(impl_->fault(), image, descriptor, size(),
                 [&] { return impl_->describe(image, descriptor); });
}

std::string_view ChangeRemoval::last_fault() const noexcept { return impl_->fault(); }

std::size_t ChangeRemoval::components() const noexcept { return impl_->components(); }

Image ChangeRemoval::last_picture() const noexcept { return view(impl_->picture()); }

}  // namespace seqloop::opencv
