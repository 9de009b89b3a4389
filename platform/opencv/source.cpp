// SPDX-License-Identifier: MIT
#include "seqloop/opencv/source.hpp"

#include <string>
#include <utility>

#include "seqloop/fault.hpp"
#include "seqloop/opencv/image_folder_source.hpp"
#include "seqloop/opencv/video_source.hpp"

namespace seqloop::opencv {

std::unique_ptr<FrameSource> open_source(const std::filesystem::path& path, SourceOptions options) {
  const std::string name = path.string();
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  switch (status.type()) {
    case std::filesystem::file_type::directory:
      return std::make_unique<ImageFolderSource>(path, options.gray, options.frames_per_second,
                                                 std::move(options.jpeg));
    case std::filesystem::file_type::regular:
      if (has_image_extension(path))
        throw SetupError(
            Fault{name, "is a single picture", "name the folder that holds the drive"});
      return std::make_unique<VideoSource>(path, options.gray, std::move(options.mjpg));
    case std::filesystem::file_type::character:
      throw SetupError(Fault{name, "is a device, not a recording",
                             "record the drive first and name the video file or image folder"});
    case std::filesystem::file_type::not_found:
      if (name.find("://") != std::string::npos)
        throw SetupError(Fault{name, "is an address of a network, and no file",
                               "feed it into a virtual camera, or record it to a video file"});
      if (!name.empty() && name.find_first_not_of("0123456789") == std::string::npos)
        throw SetupError(Fault{name, "does not exist",
                               "if it is the number of a camera, name /dev/video" + name});
      throw SetupError(Fault{name, "does not exist", "check the name"});
    case std::filesystem::file_type::none:
    case std::filesystem::file_type::unknown:
      throw SetupError(Fault{name, "cannot be read: " + error.message(), "check the permissions"});
    default:
      throw SetupError(
          Fault{name, "is neither a folder nor a file", "name an image folder or a video"});
  }
}

}  // namespace seqloop::opencv
