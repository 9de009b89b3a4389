// SPDX-License-Identifier: MIT
#include "seqloop/opencv/image_folder_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "opencv/detail/natural_order.hpp"
#include "seqloop/fault.hpp"
#include "seqloop/opencv/file_codecs.hpp"
#include "seqloop/opencv/picture_file_decoder.hpp"

namespace seqloop::opencv {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 9> extensions{".jpg", ".jpeg", ".png",  ".bmp", ".pgm",
                                                     ".ppm", ".tif",  ".tiff", ".webp"};
constexpr std::size_t of_jpeg = 2;  // the first of these
constexpr std::uintmax_t most_file_bytes = std::uintmax_t{1} << 30;
constexpr std::size_t most_named = 3;  // files that a note names before it says "..."

struct Listing {
  std::vector<std::string> pictures;
  std::vector<std::string> others;
};

bool is_one_of(const fs::path& path, std::span<const std::string_view> endings) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return std::find(endings.begin(), endings.end(), extension) != endings.end();
}

/// A dangling link to a picture, and one that must not be looked at, stay in the drive, as
/// unreadable frames: the numbers of the frames behind them do not move.
bool is_picture(const fs::directory_entry& entry) {
  if (entry.path().filename().string().starts_with('.') || !has_image_extension(entry.path()))
    return false;
  std::error_code error;
  const fs::file_type type = entry.status(error).type();
  return type == fs::file_type::regular || type == fs::file_type::not_found ||
         type == fs::file_type::none;
}

/// The first few of these names.
std::string some(const std::vector<std::string>& names) {
  std::string line;
  for (std::size_t i = 0; i < std::min(names.size(), most_named); ++i)
    line += (i == 0 ? "" : ", ") + names[i];
  return line + (names.size() > most_named ? ", ..." : "");
}

Listing list_folder(const fs::path& folder) {
  const std::string name = folder.string();
  std::error_code error;
  const auto status = fs::status(folder, error);
  if (!fs::exists(status)) throw SetupError(Fault{name, "does not exist", "check the name"});
  if (!fs::is_directory(status)) throw SetupError(Fault{name, "is not a folder"});
  Listing listing;
  fs::directory_iterator entries(folder, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    const std::string entry = entries->path().filename().string();
    // What is being written here has no name yet.
    if (entry.starts_with('.') && entry.find(".partial-") != std::string::npos) continue;
    (is_picture(*entries) ? listing.pictures : listing.others).push_back(entry);
  }
  if (error)
    throw SetupError(Fault{name, "cannot be read: " + error.message(), "check its permissions"});
  std::sort(listing.pictures.begin(), listing.pictures.end(), natural_less);
  std::sort(listing.others.begin(), listing.others.end(), natural_less);
  if (listing.pictures.empty())
    throw SetupError(
        {name,
         "holds no pictures" + (listing.others.empty() ? "" : ", but " + some(listing.others)),
         "name a folder with jpg, png, bmp, pgm, ppm, tif or webp files"});
  return listing;
}

std::string size_text(std::uint64_t width, std::uint64_t height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

bool has_image_extension(const std::filesystem::path& path) { return is_one_of(path, extensions); }

class ImageFolderSource::Impl {
 public:
  Impl(fs::path folder, bool gray, double frames_per_second, std::unique_ptr<PictureDecoder> jpeg)
      : folder_(std::move(folder)),
        listing_(list_folder(folder_)),
        decoder_(gray, std::move(jpeg)),
        frames_per_second_(frames_per_second) {
    if (!std::isfinite(frames_per_second_) || frames_per_second_ <= 0.0)
      throw SetupError(Fault{"frame rate", "is not a positive number"});
    // Readers that cannot be loaded are no fault of the pictures: said once, not of each of them.
    const auto is_jpeg = [](const std::string& name) {
      return is_one_of(name, std::span(extensions).first<of_jpeg>());
    };
    if (!std::ranges::all_of(listing_.pictures, is_jpeg)) static_cast<void>(file_codecs());
  }

  [[nodiscard]] Grab grab(Frame& frame) noexcept {
    frame = Frame{};
    frame.index = next_;
    frame.time_s = static_cast<double>(next_) / frames_per_second_;
    if (next_ == listing_.pictures.size()) return Grab::end;
    const std::string& name = listing_.pictures[next_++];
    try {
      Image image;
      const std::string reason = read_picture(folder_ / name, image);
      if (reason.empty()) {
        count_size(name, image);
        frame.image = image;
        return Grab::frame;
      }
      fault_ = name + ": " + reason;
      frame.fault = fault_;
    } catch (...) {
      frame.fault = "out of memory";
    }
    return Grab::unreadable;
  }

  [[nodiscard]] std::size_t count() const noexcept { return listing_.pictures.size(); }

  [[nodiscard]] std::vector<std::string> notes() const {
    std::vector<std::string> lines;
    if (const auto& others = listing_.others; !others.empty()) {
      lines.push_back(std::to_string(others.size()) +
                      (others.size() == 1 ? " other file ignored: " : " other files ignored: ") +
                      some(others));
    }
    if (odd_sizes_ > 0)
      lines.push_back(std::to_string(odd_sizes_) + " of " + std::to_string(next_) +
                      " pictures differ in size from the first (" + first_size_ +
                      "): " + odd_example_ + (odd_sizes_ > 1 ? ", ..." : ""));
    return lines;
  }

 private:
  /// @param image written: the picture, in memory of this source or its decoder
  /// @return why the picture could not be read; empty when it could
  [[nodiscard]] std::string read_picture(const fs::path& path, Image& image) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) return "the file is not there or cannot be read";
    if (size > most_file_bytes) return "the file is larger than 1 GiB";
    file_.resize(static_cast<std::size_t>(size));
    std::ifstream stream(path, std::ios::binary);
    stream.read(static_cast<char*>(static_cast<void*>(file_.data())),
                static_cast<std::streamsize>(file_.size()));
    if (!stream) return "the file cannot be read";
    return std::string(decoder_.decode({.bytes = file_}, image));
  }

  void count_size(const std::string& name, const Image& image) {
    const std::string size = size_text(static_cast<std::uint64_t>(image.width),
                                       static_cast<std::uint64_t>(image.height));
    if (first_size_.empty()) first_size_ = size;
    if (size == first_size_) return;
    if (odd_sizes_++ == 0) odd_example_ = name + " (" + size + ")";
  }

  fs::path folder_;
  Listing listing_;
  PictureFileDecoder decoder_;
  double frames_per_second_;
  std::size_t next_ = 0;
  std::vector<std::uint8_t> file_;
  std::string fault_;
  std::string first_size_;
  std::size_t odd_sizes_ = 0;
  std::string odd_example_;
};

ImageFolderSource::ImageFolderSource(const std::filesystem::path& folder, bool gray,
                                     double frames_per_second, std::unique_ptr<PictureDecoder> jpeg)
    : impl_(std::make_unique<Impl>(folder, gray, frames_per_second, std::move(jpeg))) {}

ImageFolderSource::~ImageFolderSource() = default;

Grab ImageFolderSource::grab(Frame& frame) noexcept { return impl_->grab(frame); }

std::optional<std::uint64_t> ImageFolderSource::frame_count() const noexcept {
  return impl_->count();
}

std::vector<std::string> ImageFolderSource::notes() const { return impl_->notes(); }

}  // namespace seqloop::opencv
