// SPDX-License-Identifier: MIT
#include "seqloop/turbojpeg/mjpg_decoder.hpp"

#include <turbojpeg.h>

#include <charconv>
#include <cstdint>
#include <exception>
#include <span>
#include <string_view>
#include <vector>

#include "seqloop/fixed_text.hpp"
#include "turbojpeg/detail/jpeg_header.hpp"

namespace seqloop::turbojpeg {
namespace {

constexpr std::uint64_t most_pixels = 200'000'000;  // largest camera sensors; 0.6 GB when decoded

using Decompressor = std::unique_ptr<void, decltype(&tjDestroy)>;

struct Size {
  int width = 0;
  int height = 0;
  bool operator==(const Size&) const = default;
};

/// A whole, a half, a quarter or an eighth of the picture, the smallest that is as large as needed
/// both ways. The eighths in between take longer than the whole picture does: 0.75 ms for 7/8 of
/// 640x360, 0.55 for all of it.
Size reduced(const Size& full, const PictureNeeds& needs) {
  if (needs.width <= 0 || needs.height <= 0) return full;
  Size smallest = full;
  for (const int part : {2, 4, 8}) {
    const Size size{TJSCALED(full.width, (tjscalingfactor{1, part})),
                    TJSCALED(full.height, (tjscalingfactor{1, part}))};
    if (size.width < needs.width || size.height < needs.height) break;
    smallest = size;
  }
  return smallest;
}

/// Whether libjpeg complains of a few bytes between the picture's data and its end and of nothing
/// else: it keeps its first warning, and after the end there is no other.
bool is_padding(std::string_view warning) {
  constexpr std::string_view before = "Corrupt JPEG data: ";
  constexpr std::string_view behind = " extraneous bytes before marker 0xd9";
  if (!warning.starts_with(before) || !warning.ends_with(behind)) return false;
  warning.remove_prefix(before.size());
  int bytes = 0;
  const char* end = warning.data() + warning.size() - behind.size();
  const auto [stopped, error] = std::from_chars(warning.data(), end, bytes);
  return error == std::errc() && stopped == end && bytes <= MjpgDecoder::most_padding;
}

}  // namespace

class MjpgDecoder::Impl {
 public:
  explicit Impl(const PictureNeeds& needs) : needs_(needs) {}

  /// May throw std::bad_alloc.
  [[nodiscard]] std::string_view decode(const RawPicture& raw, Image& image) {
    if (!check(raw)) return fault_.view();
    take_memory({raw.width, raw.height});
    // A new one for every frame (0.2 us): an old one fills in tables from the frames before.
    const Decompressor decompressor(tjInitDecompress(), &tjDestroy);
    if (!decompressor) return "no memory left to decode the JPEG picture";
    const int stride = scaled_.width * channels();
    const int failed = tjDecompress2(decompressor.get(), raw.bytes.data(), raw.bytes.size(),
                                     pixels_.data(), scaled_.width, stride, scaled_.height,
                                     needs_.gray_is_enough ? TJPF_GRAY : TJPF_BGR, 0);
    if (failed != 0 && !is_padding(tjGetErrorStr2(decompressor.get()))) {
      fault_.assign({"the JPEG picture is damaged (", tjGetErrorStr2(decompressor.get()), ")"});
      return fault_.view();
    }
    image = {pixels_.data(), scaled_.width, scaled_.height, static_cast<std::size_t>(stride),
             needs_.gray_is_enough ? PixelFormat::gray8 : PixelFormat::bgr8};
    return {};
  }

 private:
  [[nodiscard]] int channels() const { return needs_.gray_is_enough ? 1 : 3; }

  /// Sets the fault where it finds one.
  [[nodiscard]] bool check(const RawPicture& raw) {
    JpegHeader header;
    fault_.clear();
    if (raw.format != RawFormat::mjpg) {
      fault_.assign({"the frame is ", name(raw.format), ", not MJPG"});
    } else if (raw.bytes.empty()) {
      fault_.assign({"the frame is empty"});
    } else if (const std::string_view fault = read_jpeg_header(raw.bytes, header); !fault.empty()) {
      fault_.assign({fault});
    } else if (header.width != raw.width || header.height != raw.height) {
      fault_.assign({"the JPEG picture is "});
      append({header.width, header.height});
      fault_.append(", but the camera agreed to ");
      append({raw.width, raw.height});
    } else if (static_cast<std::uint64_t>(raw.width) * static_cast<std::uint64_t>(raw.height) >
               most_pixels) {
      fault_.assign({"the JPEG picture has more than 200 million pixels"});
    }
    return fault_.empty();
  }

  void append(const Size& size) {
    const auto number = [](int value) { return static_cast<std::uint64_t>(value < 0 ? 0 : value); };
    fault_.append_number(number(size.width));
    fault_.append("x");
    fault_.append_number(number(size.height));
  }

  void take_memory(const Size& full) {
    if (full == full_) return;
    const Size scaled = reduced(full, needs_);
    pixels_.resize(static_cast<std::size_t>(scaled.width) *
                   static_cast<std::size_t>(scaled.height) * static_cast<std::size_t>(channels()));
    full_ = full;
    scaled_ = scaled;
  }

  PictureNeeds needs_;
  Size full_;
  Size scaled_;
  std::vector<std::uint8_t> pixels_;
  FixedText fault_;
};

MjpgDecoder::MjpgDecoder(const PictureNeeds& needs) : impl_(std::make_unique<Impl>(needs)) {}

MjpgDecoder::~MjpgDecoder() = default;

std::string_view MjpgDecoder::decode(const RawPicture& raw, Image& image) noexcept {
  try {
    return impl_->decode(raw, image);
  } catch (const std::exception&) {
    return "no memory left for a picture of this size";
  }
}

}  // namespace seqloop::turbojpeg
