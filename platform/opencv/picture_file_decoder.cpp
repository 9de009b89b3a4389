// SPDX-License-Identifier: MIT
#include "seqloop/opencv/picture_file_decoder.hpp"

#include <limits>
#include <new>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>

#include "opencv/detail/one_line.hpp"
#include "opencv/detail/picture_file.hpp"
#include "opencv/detail/picture_view.hpp"
#include "seqloop/fault.hpp"
#include "seqloop/opencv/file_codecs.hpp"

namespace seqloop::opencv {
namespace {

constexpr std::string_view unreadable = "the file is no readable picture";

/// Turns a picture as EXIF's orientation says. @param orientation 2 to 8
void turn(const cv::Mat& picture, int orientation, cv::Mat& turned) {
  constexpr int top_bottom = 0;
  constexpr int left_right = 1;
  constexpr int both = -1;
  const bool sideways = orientation >= 5;
  if (sideways) cv::transpose(picture, turned);
  if (orientation == 5) return;
  const bool half_turn = orientation == 3 || orientation == 7;
  const bool mirrored = orientation == 2 || orientation == 6;
  cv::flip(sideways ? turned : picture, turned,
           half_turn ? both : (mirrored ? left_right : top_bottom));
}

}  // namespace

class PictureFileDecoder::Impl {
 public:
  Impl(bool gray, std::unique_ptr<PictureDecoder> jpeg)
      : flags_(gray ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR), jpeg_(std::move(jpeg)) {}

  /// May throw std::bad_alloc.
  [[nodiscard]] std::string_view decode(std::span<const std::uint8_t> file, Image& image) {
    if (file.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) return unreadable;
    const PictureFile seen = look_at(file);
    if (!seen.fault.empty()) return seen.fault;
    const auto no_memory = [&](const std::string& why) {
      fault_ = "there is not enough memory for " +
               (seen.width > 0 ? "a picture of " + std::to_string(seen.width) + "x" +
                                     std::to_string(seen.height)
                               : "the picture" + why);
      return std::string_view(fault_);
    };
    try {
      // Four inks are OpenCV's business.
      return jpeg_ && seen.jpeg && seen.components != 4 ? decode_jpeg(file, seen.orientation, image)
                                                        : decode_any(file, seen.white, image);
    } catch (const cv::Exception& failure) {  // sizes that OpenCV refuses
      if (failure.code == cv::Error::StsNoMem) return no_memory(" (" + one_line(failure.err) + ")");
    } catch (const std::bad_alloc&) {
      return no_memory("");
    } catch (const SetupError& error) {  // codecs that cannot be loaded
      return fault_ = error.what();
    }
    return unreadable;
  }

 private:
  /// @param white its value in a PGM or PPM; 0: other formats
  [[nodiscard]] std::string_view decode_any(std::span<const std::uint8_t> file, std::uint64_t white,
                                            Image& image) {
    // Of two bytes OpenCV keeps the upper one, whatever white is: little of 10 or 12 bits.
    const bool deep = white > 255 && white < 65'535;
    // One byte it takes as it is, where it is no text: a picture of 7 bits stays dark.
    const bool shallow = white > 0 && white < 255 && file[1] >= '5';
    // Not into the old picture: given one, imdecode leaves it there for some files it cannot read.
    picture_.release();
    picture_ = file_codecs().decode(file, deep ? flags_ | cv::IMREAD_ANYDEPTH : flags_);
    if (picture_.empty()) return unreadable;
    if (deep || shallow) picture_.convertTo(picture_, CV_8U, 255.0 / static_cast<double>(white));
    image = view(picture_);
    return {};
  }

  [[nodiscard]] std::string_view decode_jpeg(std::span<const std::uint8_t> file, int orientation,
                                             Image& image) {
    const std::string_view fault = jpeg_->decode({.bytes = file, .format = RawFormat::mjpg}, image);
    if (!fault.empty() || orientation == 1) return fault;
    turn(matrix(image), orientation, picture_);
    image = view(picture_);
    return {};
  }

  int flags_;
  std::unique_ptr<PictureDecoder> jpeg_;
  cv::Mat picture_;
  std::string fault_;
};

PictureFileDecoder::PictureFileDecoder(bool gray, std::unique_ptr<PictureDecoder> jpeg)
    : impl_(std::make_unique<Impl>(gray, std::move(jpeg))) {}

PictureFileDecoder::~PictureFileDecoder() = default;

std::string_view PictureFileDecoder::decode(const RawPicture& raw, Image& image) noexcept {
  try {
    return impl_->decode(raw.bytes, image);
  } catch (const std::exception&) {
    return "out of memory";
  }
}

}  // namespace seqloop::opencv
