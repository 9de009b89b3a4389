// SPDX-License-Identifier: MIT
#include "seqloop/turbojpeg/jpeg_file_decoder.hpp"

#include <turbojpeg.h>

#include <cstddef>
#include <exception>
#include <memory>

#include "turbojpeg/detail/decompress.hpp"

namespace seqloop::turbojpeg {
namespace {

struct Header {
  int width = 0;
  int height = 0;
  int colours = TJCS_GRAY;
};

/// @return without a size where the bytes are no JPEG picture
Header read_header(std::span<const std::uint8_t> jpeg) {
  Header header;
  int subsampling = 0;
  const std::unique_ptr<void, decltype(&tjDestroy)> reader(tjInitDecompress(), &tjDestroy);
  // It fails for warnings, too: those are judged with the picture.
  if (reader)
    static_cast<void>(tjDecompressHeader3(reader.get(), jpeg.data(), jpeg.size(), &header.width,
                                          &header.height, &subsampling, &header.colours));
  return header;
}

}  // namespace

std::string_view JpegFileDecoder::decode(const RawPicture& raw, Image& image) noexcept {
  const Header header = read_header(raw.bytes);
  if (header.width <= 0 || header.height <= 0) return "the file is no readable JPEG picture";
  if (header.colours == TJCS_CMYK || header.colours == TJCS_YCCK)
    return "the JPEG picture has four colours";
  const auto pixels =
      static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height);
  if (pixels > most_pixels) return "the JPEG picture has more than 200 million pixels";
  const std::size_t channels = format_ == PixelFormat::gray8 ? 1 : 3;
  const std::size_t bytes = static_cast<std::size_t>(pixels) * channels;
  try {
    if (pixels_.size() != bytes) {
      pixels_ = std::vector<std::uint8_t>();  // first, so that no two pictures are held
      pixels_.resize(bytes);
    }
  } catch (const std::exception&) {
    set_no_memory(fault_, header.width, header.height);
    return fault_.view();
  }
  if (!decompress(raw.bytes, {pixels_.data(), header.width, header.height, format_}, fault_))
    return fault_.view();
  image = {pixels_.data(), header.width, header.height,
           static_cast<std::size_t>(header.width) * channels, format_};
  return {};
}

}  // namespace seqloop::turbojpeg
