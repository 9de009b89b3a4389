// SPDX-License-Identifier: MIT
#include "seqloop/opencv/builtin_describer.hpp"

#include <string>

#include "opencv/detail/builtin_model.hpp"
#include "opencv/detail/guarded.hpp"
#include "opencv/detail/oriented_gradients.hpp"
#include "opencv/detail/picture_scaler.hpp"
#include "seqloop/difference.hpp"

namespace seqloop::opencv {
namespace {

class BuiltinDescriber : public Describer {
 public:
  [[nodiscard]] std::size_t size() const noexcept override { return OrientedGradients::size; }

  [[nodiscard]] PictureNeeds needs() const noexcept override {
    return {.width = OrientedGradients::width,
            .height = OrientedGradients::height,
            .gray_is_enough = true};
  }

  [[nodiscard]] Description describe(const Image& image,
                                     std::span<float> descriptor) noexcept override {
    return guarded(fault_, image, descriptor, size(), [&] {
      const cv::Mat picture = scaler_.scale(image);
      gradients_.describe(picture.ptr<std::uint8_t>(), picture.step[0], descriptor);
      return normalise(descriptor) ? Description::good : Description::blank;  // Eq. (1)
    });
  }

  [[nodiscard]] std::string_view last_fault() const noexcept override { return fault_; }

 private:
  PictureScaler scaler_{cv::Size(OrientedGradients::width, OrientedGradients::height), true};
  OrientedGradients gradients_;
  std::string fault_;
};

}  // namespace

std::unique_ptr<Describer> make_builtin_describer() { return std::make_unique<BuiltinDescriber>(); }

std::unique_ptr<DnnDescriber> make_builtin_net() {
  ModelSettings settings;
  settings.model = "built-in descriptor";
  return std::make_unique<DnnDescriber>(builtin_model(), settings);
}

}  // namespace seqloop::opencv
