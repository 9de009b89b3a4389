// SPDX-License-Identifier: MIT
#include "seqloop/opencv/dnn_describer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "opencv/detail/guarded.hpp"
#include "opencv/detail/model.hpp"
#include "opencv/detail/one_line.hpp"
#include "opencv/detail/picture_blob.hpp"
#include "opencv/detail/picture_view.hpp"
#include "opencv/detail/quiet_log.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::opencv {
namespace {

/// Fused and plain arithmetic differ by rounding; where they differ by more than this, relative to
/// the descriptor's norm, the fused values are wrong.
constexpr double fusion_tolerance = 1e-3;

constexpr int largest_input =
    8192;  // pixels a side; beyond it a mistyped size would take all memory

void check_numbers(const ModelSettings& settings, Faults& faults) {
  const auto finite = [](float value) { return std::isfinite(value); };
  if (!std::all_of(settings.mean.begin(), settings.mean.end(), finite))
    faults.push_back({"mean", "is not finite"});
  if (!finite(settings.scale) || settings.scale == 0.0F)
    faults.push_back({"scale", "is zero or not finite"});
  if (settings.input_width < 0 || settings.input_height < 0 ||
      (settings.input_width == 0) != (settings.input_height == 0) ||
      std::max(settings.input_width, settings.input_height) > largest_input)
    faults.push_back({"input size",
                      std::to_string(settings.input_width) + "x" +
                          std::to_string(settings.input_height) + " is no size",
                      "give width and height, both from 1 to " + std::to_string(largest_input)});
}

/// Loads the model and keeps its faults in the list instead of throwing them.
template <typename Load>
Model load_into(Faults& faults, Load load) {
  try {
    return load();
  } catch (const SetupError& error) {
    faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    throw SetupError(std::move(faults));  // without a model there is nothing more to find
  }
}

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

PictureBlob::Layout make_layout(const ModelSettings& settings, const Model& model,
                                const std::string& layer, Faults& faults) {
  const std::string name = settings.model.string();
  if (layer.empty())
    faults.push_back({name, "has no layer '" + settings.layer + "'",
                      "its layers are: " + listed(layer_names(model))});
  PictureBlob::Layout layout;
  layout.channels = model.channels == 0 ? 3 : model.channels;
  if (layout.channels != 1 && layout.channels != 3)
    faults.push_back(
        {name, "wants " + std::to_string(layout.channels) + " channels, and a picture has 1 or 3"});
  layout.width = settings.input_width > 0 ? settings.input_width : model.width;
  layout.height = settings.input_height > 0 ? settings.input_height : model.height;
  if (settings.input_width == 0 && (layout.width == 0 || layout.height == 0))
    faults.push_back({name, "does not say which input size it wants", "set the input size"});
  layout.mean = settings.mean;
  layout.scale = settings.scale;
  layout.swap_rb = settings.swap_rb;
  return layout;
}

}  // namespace

class DnnDescriber::Impl {
 public:
  /// @param load gives the Model or throws SetupError
  template <typename Load>
  static std::unique_ptr<Impl> build(const ModelSettings& settings, Load load) {
    const QuietLog quiet;
    Faults faults;
    check_numbers(settings, faults);
    Model model = load_into(faults, load);
    std::string layer = find_layer(model, settings.layer);
    const PictureBlob::Layout layout = make_layout(settings, model, layer, faults);
    if (!faults.empty()) throw SetupError(std::move(faults));
    try {
      auto impl = std::make_unique<Impl>(std::move(model), layer, layout);
      // Loaded again, because a net that was fused once keeps wrong layers when fusion goes.
      if (!impl->fuse()) impl = std::make_unique<Impl>(load(), layer, layout);
      return impl;
    } catch (const cv::Exception& error) {
      throw SetupError(Fault{settings.model.string(),
                             "cannot be computed on " + std::to_string(layout.channels) + "x" +
                                 std::to_string(layout.height) + "x" +
                                 std::to_string(layout.width) + " values (" + one_line(error.err) +
                                 ")",
                             "check the input size, and that the model's weights are there"});
    }
  }

  /// Runs the net once, without fusion. May throw cv::Exception.
  Impl(const Model& model, std::string layer, const PictureBlob::Layout& layout)
      : net_(model.net),
        layer_(std::move(layer)),
        blob_(layout),
        input_(layout.width, layout.height),
        gray_(layout.channels == 1) {
    net_.enableFusion(false);
    size_ = forward_noise(1).total();
    if (size_ == 0) CV_Error(cv::Error::StsBadSize, "the layer's output is empty");
  }

  /// Switches fusion on. OpenCV 4.6 lets a concatenation write elsewhere the output of a fused
  /// activation before it even when that output is asked for, so whether fusion keeps the layer's
  /// values has to be tried.
  /// @return false when it does not; this object is of no use then
  [[nodiscard]] bool fuse() {
    const cv::Mat plain = forward_noise(1).clone();
    // A fused net that never writes the layer must not find the right values in recycled memory.
    static_cast<void>(forward_noise(2));
    net_.enableFusion(true);
    const cv::Mat fused = forward_noise(1);
    const double scale = cv::norm(plain);
    return fused.total() == size_ && scale > 0.0 &&
           cv::norm(fused, plain) <= fusion_tolerance * scale;
  }

  /// May throw.
  [[nodiscard]] Description describe(const Image& image, std::span<float> descriptor) {
    const cv::Mat output = forward(image);
    if (output.total() != size_) return fail("the layer's output changed its size");
    const std::span<const float> features(output.ptr<float>(), size_);
    if (!std::isfinite(squared_norm(features)))
      return fail("the layer gives NaN or infinity for this picture");
    std::copy(features.begin(), features.end(), descriptor.begin());
    return normalise(descriptor) ? Description::good : Description::blank;  // Eq. (1)
  }

  Description fail(std::string reason) {
    fault_ = std::move(reason);
    return Description::failed;
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool gray() const noexcept { return gray_; }
  [[nodiscard]] const cv::Size& input() const noexcept { return input_; }
  [[nodiscard]] std::string& fault() noexcept { return fault_; }

  [[nodiscard]] std::size_t layers_run() {
    std::vector<double> ticks;
    net_.getPerfProfile(ticks);
    return static_cast<std::size_t>(
        std::count_if(ticks.begin(), ticks.end(), [](double t) { return t > 0.0; }));
  }

 private:
  /// The layer's output; the net owns it.
  [[nodiscard]] cv::Mat forward(const Image& image) {
    blob_.fill(image);
    net_.setInput(blob_.mat());
    cv::Mat output = net_.forward(layer_);
    if (output.type() != CV_32F || !output.isContinuous())
      CV_Error(cv::Error::StsUnsupportedFormat, "the layer's output is not float32");
    return output;
  }

  /// The output for a picture of noise that depends on the seed.
  [[nodiscard]] cv::Mat forward_noise(std::uint64_t seed) {
    cv::Mat noise(input_, CV_8UC1);
    cv::RNG(seed).fill(noise, cv::RNG::UNIFORM, 0, 256);
    return forward(view(noise));
  }

  cv::dnn::Net net_;
  std::string layer_;  ///< OpenCV's name
  PictureBlob blob_;
  cv::Size input_;
  bool gray_;
  std::size_t size_ = 0;
  std::string fault_;
};

DnnDescriber::DnnDescriber(const ModelSettings& settings)
    : impl_(Impl::build(
          settings, [&settings] { return load_model(settings.model, settings.config_model); })) {}

DnnDescriber::DnnDescriber(std::span<const unsigned char> onnx, const ModelSettings& settings)
    : impl_(Impl::build(settings,
                        [onnx, &settings] { return load_onnx(onnx, settings.model.string()); })) {}

DnnDescriber::~DnnDescriber() = default;

std::size_t DnnDescriber::size() const noexcept { return impl_->size(); }

PictureNeeds DnnDescriber::needs() const noexcept {
  return {.width = input_width(), .height = input_height(), .gray_is_enough = gray()};
}

Description DnnDescriber::describe(const Image& image, std::span<float> descriptor) noexcept {
  return guarded(impl_->fault(), image, descriptor, size(),
                 [&] { return impl_->describe(image, descriptor); });
}

std::string_view DnnDescriber::last_fault() const noexcept { return impl_->fault(); }

bool DnnDescriber::gray() const noexcept { return impl_->gray(); }

int DnnDescriber::input_width() const noexcept { return impl_->input().width; }

int DnnDescriber::input_height() const noexcept { return impl_->input().height; }

std::size_t DnnDescriber::layers_run() const { return impl_->layers_run(); }

}  // namespace seqloop::opencv
