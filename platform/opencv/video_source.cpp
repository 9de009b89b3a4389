// SPDX-License-Identifier: MIT
#include "seqloop/opencv/video_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <utility>
#include <vector>

#include "opencv/detail/avi_header.hpp"
#include "opencv/detail/avi_pictures.hpp"
#include "opencv/detail/little_endian.hpp"
#include "opencv/detail/picture_file.hpp"
#include "opencv/detail/picture_view.hpp"
#include "opencv/detail/quiet_log.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/fault.hpp"
#include "seqloop/opencv/file_codecs.hpp"

namespace seqloop::opencv {
namespace {

constexpr double default_rate =
    25.0;  // frames a second, where the file does not tell; FFmpeg's too
constexpr double largest_count = 1e12;  // some backends report 2^63 for "unknown"

/// Left to choose, OpenCV also takes a file for an image sequence and looks for cameras on the USB.
/// GStreamer writes to stderr by itself and leaks, for nothing that FFmpeg cannot read.
constexpr std::array<cv::VideoCaptureAPIs, 2> backends{cv::CAP_FFMPEG, cv::CAP_OPENCV_MJPEG};

/// @return empty where it cannot be read
std::vector<std::uint8_t> head_of(const std::filesystem::path& file) {
  constexpr std::size_t as_far_as_headers_reach = 65'536;
  std::vector<std::uint8_t> head(as_far_as_headers_reach);
  std::ifstream stream(file, std::ios::binary);
  stream.read(static_cast<char*>(static_cast<void*>(head.data())),
              static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  return head;
}

}  // namespace

class VideoSource::Impl {
 public:
  Impl(const std::filesystem::path& file, bool gray, std::unique_ptr<PictureDecoder> mjpg)
      : mjpg_(std::move(mjpg)), gray_(gray) {
    const QuietLog quiet;
    const std::string name = file.string();
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status))
      throw SetupError(Fault{name, "does not exist", "check the name"});
    if (!std::filesystem::is_regular_file(status)) throw SetupError(Fault{name, "is not a file"});
    try {
      const std::vector<std::uint8_t> head = head_of(file);
      avi_ = read_avi_header(head);
      constexpr int a_few = 10;  // not the first alone: webcams often damage it
      pending_ = begin_jpeg(file, a_few);
      if (!pending_) {
        capture_ = file_codecs().video();
        if (std::none_of(backends.begin(), backends.end(), [&](cv::VideoCaptureAPIs backend) {
              return capture_->open(name, backend);
            }))
          throw SetupError(
              Fault{name, "is not a video that OpenCV can read",
                    "convert it, for instance to .mp4 or .avi, or use a folder of pictures"});
        read_properties(head);
        pending_ = read();  // some files open well and hold no frame
        if (!pending_) pending_ = begin_jpeg(file, std::numeric_limits<int>::max());
      }
    } catch (const cv::Exception& failure) {
      throw SetupError(Fault{name, "is not a video that OpenCV can read (" + failure.err + ")"});
    }
    if (!pending_) throw SetupError(Fault{name, "holds no frame that can be decoded"});
  }

  [[nodiscard]] Grab grab(Frame& frame) noexcept {
    frame = Frame{};
    frame.index = next_;
    try {
      if (!pending_ && !ended_) ended_ = !read();
      if (!ended_ && !pictures_)
        frame.image = view(gray_ && picture_.channels() == 3 ? to_gray() : picture_);
    } catch (...) {  // the backend gave up
      ended_ = true;
    }
    frame.time_s = time_s_;
    pending_ = false;
    if (ended_) return Grab::end;
    ++next_;
    if (!pictures_) return Grab::frame;
    (usable_ ? frame.remark : frame.fault) = damage_;
    if (usable_) frame.image = image_;
    return usable_ ? Grab::frame : Grab::unreadable;
  }

  [[nodiscard]] std::optional<std::uint64_t> declared() const noexcept { return declared_; }

  [[nodiscard]] std::vector<std::string> notes() const {
    std::vector<std::string> lines;
    if (!rate_told_)
      lines.emplace_back(
          "the video does not say its frame rate: it is taken for 25 frames a second");
    if (!given_up_.empty())
      lines.push_back("none of its first pictures can be decoded by itself (" + given_up_ +
                      "): OpenCV reads the video, which does not tell of damaged pictures, and may "
                      "leave out what it cannot read or end there");
    const std::uint64_t begun = pictures_ ? pictures_->begun() : next_;
    if (ended_ && declared_ && begun < *declared_)
      lines.push_back("the video ended after " + std::to_string(begun) + " of the " +
                      counted(*declared_, "frame") + " that it declares");
    return lines;
  }

 private:
  /// OpenCV does not tell whether a file says its rate: its backends put 25 there where an AVI file
  /// has zeros, and where JPEG pictures follow each other without any container. Other formats are
  /// taken at their word.
  void read_properties(Bytes head) {
    const bool told = avi_ ? avi_->rate > 0.0 : !has(head, 0, "\xff\xd8\xff");
    set_rate(told ? capture_->get(cv::CAP_PROP_FPS) : 0.0);
    const double count = capture_->get(cv::CAP_PROP_FRAME_COUNT);
    if (count >= 1.0 && count < largest_count) declared_ = static_cast<std::uint64_t>(count);
  }

  /// @param rate frames a second, as told by the file
  void set_rate(double rate) {
    rate_told_ = std::isfinite(rate) && rate > 0.0;
    if (rate_told_) rate_ = rate;
  }

  /// Leaves reading to AviPictures and decoding to mjpg_ where they can.
  /// @param looked_at so many pictures at most, of which one must be decoded
  /// @return whether the first picture is there
  [[nodiscard]] bool begin_jpeg(const std::filesystem::path& file, int looked_at) {
    if (!mjpg_ || !avi_ || !avi_->motion_jpeg) return false;
    pictures_.emplace(file, *avi_);
    bool any_usable = false;
    for (int i = 0; i < looked_at && !any_usable && read(); ++i) any_usable = usable_;
    pictures_.emplace(file, *avi_);
    if (!any_usable || !read()) {
      pictures_.reset();  // some cameras send every second line as a picture of its own
      given_up_ = damage_;
      return false;
    }
    capture_.reset();
    given_up_.clear();
    set_rate(avi_->rate);
    if (avi_->frames > 0) declared_ = avi_->frames;
    first_number_ = pictures_->number();
    time_s_ = 0.0;
    return true;
  }

  /// Decodes and moves the clock. @return false at the end
  [[nodiscard]] bool read() { return pictures_ ? read_jpeg() : read_any(); }

  /// Into image_, or sets why not.
  [[nodiscard]] bool read_jpeg() {
    if (!pictures_->next(jpeg_)) return false;
    time_s_ = static_cast<double>(pictures_->number() - first_number_) / rate_;
    damage_ = mjpg_->decode(
        {.bytes = jpeg_, .width = avi_->width, .height = avi_->height, .format = RawFormat::mjpg},
        image_);
    usable_ = damage_.empty() || make_up();
    return true;
  }

  /// Decodes a damaged picture as backends do, which make up what is missing: OpenCV's own writer
  /// loses a few bits in one picture of 50.
  [[nodiscard]] bool make_up() {
    const PictureFile seen = look_at(jpeg_);
    if (!seen.jpeg || !seen.fault.empty() ||
        seen.width != static_cast<std::uint64_t>(avi_->width) ||
        seen.height != static_cast<std::uint64_t>(avi_->height))
      return false;
    picture_ = file_codecs().decode(jpeg_, cv::IMREAD_COLOR);
    if (!picture_.empty()) image_ = view(picture_);
    return !picture_.empty();
  }

  /// Into picture_.
  [[nodiscard]] bool read_any() {
    if (!capture_->read(picture_) || picture_.empty()) return false;
    if (picture_.type() != CV_8UC1 && picture_.type() != CV_8UC3) return false;
    const double stamp = capture_->get(cv::CAP_PROP_POS_MSEC) / 1000.0;
    if (first_) {
      first_ = false;
      start_s_ = std::isfinite(stamp) ? stamp : 0.0;
      time_s_ = 0.0;
      return true;
    }
    const double since_start = stamp - start_s_;
    time_s_ =
        std::isfinite(since_start) && since_start > time_s_ ? since_start : time_s_ + 1.0 / rate_;
    return true;
  }

  [[nodiscard]] const cv::Mat& to_gray() {
    cv::cvtColor(picture_, gray_picture_, cv::COLOR_BGR2GRAY);
    return gray_picture_;
  }

  std::unique_ptr<PictureDecoder> mjpg_;
  std::optional<AviHeader> avi_;         ///< of an AVI file with a video
  std::optional<AviPictures> pictures_;  ///< of motion JPEG in one; OpenCV reads all else
  std::vector<std::uint8_t> jpeg_;
  Image image_;              ///< of pictures_, in mjpg_'s memory or picture_'s
  std::string_view damage_;  ///< likewise
  bool usable_ = false;      ///< all the same
  std::string given_up_;     ///< why mjpg_ does not decode; empty where it does
  std::uint64_t first_number_ = 0;
  std::unique_ptr<cv::VideoCapture> capture_;  ///< null: pictures_ are read
  cv::Mat picture_;
  cv::Mat gray_picture_;
  bool gray_;
  bool pending_ = false;  ///< picture_ was read ahead and not handed over yet
  bool first_ = true;
  bool ended_ = false;
  bool rate_told_ = false;
  double rate_ = default_rate;
  double start_s_ = 0.0;  ///< the container's time of the first frame
  double time_s_ = 0.0;
  std::uint64_t next_ = 0;
  std::optional<std::uint64_t> declared_;
};

VideoSource::VideoSource(const std::filesystem::path& file, bool gray,
                         std::unique_ptr<PictureDecoder> mjpg)
    : impl_(std::make_unique<Impl>(file, gray, std::move(mjpg))) {}

VideoSource::~VideoSource() = default;

Grab VideoSource::grab(Frame& frame) noexcept { return impl_->grab(frame); }

std::optional<std::uint64_t> VideoSource::frame_count() const noexcept { return impl_->declared(); }

std::vector<std::string> VideoSource::notes() const { return impl_->notes(); }

}  // namespace seqloop::opencv
