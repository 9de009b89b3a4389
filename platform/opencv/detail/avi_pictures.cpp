// SPDX-License-Identifier: MIT
#include "opencv/detail/avi_pictures.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <system_error>

#include "opencv/detail/little_endian.hpp"

namespace seqloop::opencv {
namespace {

/// Whether a chunk holds a picture of that stream: "00dc", "00db".
bool is_picture(Bytes header, int stream) {
  return header[0] == '0' + stream / 10 && header[1] == '0' + stream % 10 && header[2] == 'd' &&
         (header[3] == 'c' || header[3] == 'b');
}

bool read(std::ifstream& stream, std::uint64_t place, std::span<std::uint8_t> bytes) {
  stream.clear();
  stream.seekg(static_cast<std::streamoff>(place));
  stream.read(static_cast<char*>(static_cast<void*>(bytes.data())),
              static_cast<std::streamsize>(bytes.size()));
  return static_cast<bool>(stream);
}

}  // namespace

AviPictures::AviPictures(const std::filesystem::path& file, const AviHeader& header)
    : bytes_(file, std::ios::binary), stream_(header.stream) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (!error) size_ = size;
}

bool AviPictures::next(std::vector<std::uint8_t>& jpeg) {
  std::array<std::uint8_t, avi_list_header> header{};
  while (size_ - place_ >= avi_chunk_header && read(bytes_, place_, std::span(header).first<8>())) {
    const std::uint32_t size = little_endian(header, 4);
    const std::uint64_t content = place_ + avi_chunk_header;
    // Where pictures lie: in the lists "movi" and "rec ", of this part of the file or a later one.
    if (has(header, 0, "RIFF") || has(header, 0, "LIST")) {
      const auto list = std::span(header).last<4>();
      if (size_ - content < list.size() || !read(bytes_, content, list)) return false;
      if (header[0] == 'R' || has(header, avi_chunk_header, "movi") ||
          has(header, avi_chunk_header, "rec ")) {
        place_ = content + list.size();
        continue;
      }
    }
    if (size > size_ - content) return false;
    place_ = std::min(content + size + size % 2, size_);
    if (!is_picture(header, stream_)) continue;
    ++begun_;
    if (size == 0) continue;
    jpeg.resize(size);
    return read(bytes_, content, jpeg);
  }
  return false;
}

}  // namespace seqloop::opencv
