// SPDX-License-Identifier: MIT
#include "output.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

namespace seqloop::street {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& what, const std::string& why) {
  throw std::runtime_error(what.string() + ": " + why);
}

void write_bytes(const fs::path& file, const char* data, std::size_t size) {
  errno = 0;
  std::ofstream out(file, std::ios::binary);
  out.write(data, static_cast<std::streamsize>(size));
  out.close();
  if (!out) fail(file, errno != 0 ? std::strerror(errno) : "cannot be written");
}

class ImageFolder : public FrameSink {
 public:
  ImageFolder(fs::path folder, std::string ending)
      : folder_(std::move(folder)), ending_(std::move(ending)) {
    fs::create_directories(folder_);
    if (ending_ == ".jpg") flags_ = {cv::IMWRITE_JPEG_QUALITY, 92};
    if (ending_ == ".png") flags_ = {cv::IMWRITE_PNG_COMPRESSION, 1};
  }

  void put(const cv::Mat& image) override {
    char name[32];
    std::snprintf(name, sizeof name, "%06zu", count_++);
    const fs::path file = folder_ / (name + ending_);
    if (!cv::imencode(ending_, image, bytes_, flags_)) fail(file, "cannot be encoded");
    write_bytes(file, reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
  }

  void close() override {}

 private:
  fs::path folder_;
  std::string ending_;
  std::vector<int> flags_;
  std::vector<unsigned char> bytes_;
  std::size_t count_ = 0;
};

class AviFile : public FrameSink {
 public:
  AviFile(fs::path file, cv::Size size)
      : file_(std::move(file)),
        // OpenCV's own writer leaves the last bits of some pictures out.
        writer_(file_.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                size) {
    if (!writer_.isOpened()) fail(file_, "cannot be opened for writing");
  }

  void put(const cv::Mat& image) override {
    writer_.write(image);
    ++count_;
  }

  void close() override {
    writer_.release();
    // The writer reports no errors; a full disk shows as frames that cannot be read back.
    cv::VideoCapture back(file_.string(), cv::CAP_FFMPEG);
    std::size_t found = 0;
    while (back.isOpened() && back.grab()) ++found;
    if (found != count_) {
      fail(file_, "only " + std::to_string(found) + " of " + std::to_string(count_) +
                      " frames were written (is the disk full?)");
    }
  }

 private:
  fs::path file_;
  cv::VideoWriter writer_;
  std::size_t count_ = 0;
};

std::string read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

constexpr const char* kFirstLine = "seqloop-street drive 1\n";

/// Whether this program gives files such a name. @param name relative to the folder it makes
bool is_ours(const fs::path& name) {
  const std::string stem = name.stem();
  const std::string ending = name.extension();
  if (name.has_parent_path()) {
    return (ending == ".jpg" || ending == ".png") &&
           stem.find_first_not_of("0123456789") == std::string::npos;
  }
  if (stem == "reference" || stem == "query" || stem == "drive") {
    return ending.empty() || ending == ".avi" || ending == ".csv";
  }
  return name == "truth.csv" || name == "near.csv" || name == Staging::kMarker;
}

}  // namespace

std::unique_ptr<FrameSink> open_sink(const fs::path& folder, const std::string& name, Format format,
                                     cv::Size size) {
  if (format == Format::avi) return std::make_unique<AviFile>(folder / (name + ".avi"), size);
  return std::make_unique<ImageFolder>(folder / name, format == Format::png ? ".png" : ".jpg");
}

void write_file(const fs::path& file, const std::string& text) {
  write_bytes(file, text.data(), text.size());
}

void write_truth(const fs::path& file, const std::vector<TruthRow>& rows) {
  std::string text = "query,reference\n";
  for (const TruthRow& row : rows) {
    text += std::to_string(row.query) + ',' + std::to_string(row.reference) + '\n';
  }
  write_file(file, text);
}

void write_near(const fs::path& file, const std::vector<NearRow>& rows) {
  std::string text = "query,first,last\n";
  for (const NearRow& row : rows) {
    text += std::to_string(row.query) + ',' + std::to_string(row.first) + ',' +
            std::to_string(row.last) + '\n';
  }
  write_file(file, text);
}

void write_poses(const fs::path& file, const Drive& drive) {
  std::string text = "frame,street_m,left_m,height_m,yaw_rad,pitch_rad,roll_rad\n";
  for (std::size_t i = 0; i < drive.frames(); ++i) {
    const Shot shot = drive.shot(i);
    std::array<char, 200> row{};
    const int size =
        std::snprintf(row.data(), row.size(), "%zu,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f\n", i,
                      drive.street(i), shot.lateral, shot.height, shot.yaw, shot.pitch, shot.roll);
    text.append(row.data(), static_cast<std::size_t>(size));
  }
  write_file(file, text);
}

Staging::Staging(fs::path target) : target_(std::move(target)) {
  if (!target_.has_filename()) target_ = target_.parent_path();
  const bool empty = fs::is_directory(target_) && fs::is_empty(target_);
  if (fs::exists(target_) && !empty && read_file(target_ / kMarker).rfind(kFirstLine, 0) != 0) {
    fail(target_, "exists and is not a drive made by seqloop-street");
  }
  if (fs::is_directory(target_)) {
    for (const auto& entry : fs::recursive_directory_iterator(target_)) {
      if (is_ours(entry.path().lexically_relative(target_))) continue;
      fail(entry.path(), "would be lost with the drive that is replaced; move it elsewhere");
    }
  }
  if (target_.has_parent_path()) fs::create_directories(target_.parent_path());
  for (int i = 0;; ++i) {
    folder_ = target_;
    folder_ += ".part" + std::to_string(i);
    if (!fs::exists(folder_.string() + ".replaced") && fs::create_directory(folder_)) break;
    if (i == 99) fail(folder_, "too many unfinished drives; remove them");
  }
}

Staging::~Staging() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

void Staging::commit(const std::string& parameters) {
  write_file(folder_ / kMarker, kFirstLine + parameters);
  const bool replaced = fs::exists(target_);
  fs::path old = folder_;
  old += ".replaced";
  if (replaced) fs::rename(target_, old);
  fs::rename(folder_, target_);
  folder_.clear();
  if (replaced) fs::remove_all(old);
}

bool Staging::holds(const fs::path& target, const std::string& parameters) {
  return read_file(target / kMarker) == kFirstLine + parameters;
}

}  // namespace seqloop::street
