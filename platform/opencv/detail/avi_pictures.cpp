// SPDX-License-Identifier: MIT
#include "opencv/detail/avi_pictures.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>

#include "opencv/detail/little_endian.hpp"

namespace seqloop::opencv {
namespace {

constexpr std::size_t chunk_header = 8;  // name, size of the content
constexpr std::size_t list_header = 12;  // and the list's own name

bool is_motion_jpeg(Bytes bytes, std::size_t place) {
  return has(bytes, place, "MJPG") || has(bytes, place, "mjpg");
}

/// What the headers say of the first video.
struct Video {
  int stream = 0;
  int width = 0;
  int height = 0;
};

std::optional<Video> find_video(Bytes head) {
  if (!has(head, 0, "RIFF") || !has(head, 8, "AVI ")) return std::nullopt;
  int streams = 0;
  bool video = false;
  for (std::size_t place = list_header; place + list_header <= head.size();) {
    if (has(head, place, "LIST")) {
      if (has(head, place + chunk_header, "movi")) return std::nullopt;
      place += list_header;
      continue;
    }
    const std::size_t content = place + chunk_header;
    if (has(head, place, "strh")) {
      ++streams;
      video = has(head, content, "vids");
    }
    if (video && has(head, place, "strf")) {
      if (!is_motion_jpeg(head, content + 16)) return std::nullopt;
      const std::uint32_t width = little_endian(head, content + 4);
      const std::uint32_t height = little_endian(head, content + 8);
      constexpr std::uint32_t most = std::numeric_limits<std::uint16_t>::max();  // a JPEG's own
      if (width == 0 || width > most || height == 0 || height > most) return std::nullopt;
      return Video{streams - 1, static_cast<int>(width), static_cast<int>(height)};
    }
    const std::size_t size = little_endian(head, place + 4);
    place = content + std::min(size + size % 2, head.size());
  }
  return std::nullopt;
}

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

std::optional<AviPictures> AviPictures::open(const std::filesystem::path& file, Bytes head) {
  const auto video = find_video(head);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (!video || error) return std::nullopt;
  AviPictures pictures;
  pictures.stream_.open(file, std::ios::binary);
  pictures.size_ = size;
  pictures.stream_number_ = video->stream;
  pictures.width_ = video->width;
  pictures.height_ = video->height;
  return pictures;
}

bool AviPictures::next(std::vector<std::uint8_t>& jpeg) {
  std::array<std::uint8_t, list_header> header{};
  while (size_ - place_ >= chunk_header && read(stream_, place_, std::span(header).first<8>())) {
    const std::uint32_t size = little_endian(header, 4);
    const std::uint64_t content = place_ + chunk_header;
    // Where pictures lie: in the lists "movi" and "rec ", of this part of the file or a later one.
    if (has(header, 0, "RIFF") || has(header, 0, "LIST")) {
      const auto list = std::span(header).last<4>();
      if (size_ - content < list.size() || !read(stream_, content, list)) return false;
      if (header[0] == 'R' || has(header, chunk_header, "movi") ||
          has(header, chunk_header, "rec ")) {
        place_ = content + list.size();
        continue;
      }
    }
    if (size > size_ - content) return false;
    place_ = std::min(content + size + size % 2, size_);
    if (!is_picture(header, stream_number_)) continue;
    ++begun_;
    if (size == 0) continue;
    jpeg.resize(size);
    return read(stream_, content, jpeg);
  }
  return false;
}

}  // namespace seqloop::opencv
