// SPDX-License-Identifier: MIT
#include "seqloop/turbojpeg/encode_jpeg.hpp"

#include <turbojpeg.h>

#include <memory>

#include "seqloop/detail/format_fault.hpp"

namespace seqloop::turbojpeg {

std::vector<std::uint8_t> encode_jpeg(const Image& image, int quality) {
  if (!format_fault(image.format).empty()) return {};
  const std::unique_ptr<void, decltype(&tjDestroy)> compressor(tjInitCompress(), &tjDestroy);
  if (!compressor) return {};
  const bool gray = image.format == PixelFormat::gray8;
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int failed =
      tjCompress2(compressor.get(), image.data, image.width, static_cast<int>(image.stride),
                  image.height, gray ? TJPF_GRAY : TJPF_BGR, &bytes, &size,
                  gray ? TJSAMP_GRAY : TJSAMP_420, quality, TJFLAG_ACCURATEDCT);
  const std::unique_ptr<unsigned char, decltype(&tjFree)> owner(bytes, &tjFree);
  if (failed != 0) return {};
  return {bytes, bytes + size};
}

}  // namespace seqloop::turbojpeg
