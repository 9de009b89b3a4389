// SPDX-License-Identifier: MIT
#include "seqloop/opencv/image_folder_source.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "expect_setup_error.hpp"
#include "platform/pictures.hpp"

namespace seqloop::opencv {
namespace {

using test::encoded;
using test::says;
using test::setup_error;
using test::TemporaryFolder;
using test::textured;

/// What the next grab brings; the fault where the frame is unreadable.
struct Grabbed {
  Grab grab;
  Frame frame;
  std::string fault;
};

Grabbed next(FrameSource& source) {
  Grabbed result{};
  result.grab = source.grab(result.frame);
  result.fault = std::string(result.frame.fault);
  return result;
}

std::string folder_error(const std::filesystem::path& folder) {
  return setup_error([&] { ImageFolderSource source(folder, false); });
}

TEST(ImageFolderSource, HandsOverPicturesInNaturalOrder) {
  const TemporaryFolder folder;
  for (const int width : {10, 9, 2, 1})
    folder.write("image" + std::to_string(width) + ".PNG", encoded(textured(width, 4), ".png"));
  ImageFolderSource source(folder.path(), false, 4.0);
  EXPECT_EQ(source.frame_count(), 4U);
  std::vector<int> widths;
  for (Grabbed g = next(source); g.grab != Grab::end; g = next(source)) {
    ASSERT_EQ(g.grab, Grab::frame);
    EXPECT_EQ(g.frame.index, widths.size());
    EXPECT_EQ(g.frame.time_s, 0.25 * static_cast<double>(widths.size()));
    widths.push_back(g.frame.image.width);
  }
  EXPECT_EQ(widths, (std::vector<int>{1, 2, 9, 10}));
  EXPECT_EQ(next(source).grab, Grab::end);
}

TEST(ImageFolderSource, KeepsPixelsOfEveryFormat) {
  const cv::Mat picture = textured(20, 10);
  for (const char* extension :
       {".png", ".bmp", ".ppm", ".tif", ".tiff", ".jpg", ".jpeg", ".webp"}) {
    const TemporaryFolder folder;
    folder.write(std::string("a") + extension, encoded(picture, extension));
    ImageFolderSource source(folder.path(), false);
    const Grabbed g = next(source);
    ASSERT_EQ(g.grab, Grab::frame) << extension;
    ASSERT_EQ(g.frame.image.format, PixelFormat::bgr8);
    const cv::Mat got(10, 20, CV_8UC3, const_cast<std::uint8_t*>(g.frame.image.data),
                      g.frame.image.stride);
    const bool lossy = extension[1] == 'j' || extension[1] == 'w';
    EXPECT_LE(cv::norm(got, picture, cv::NORM_INF), lossy ? 90.0 : 0.0) << extension;
  }
}

TEST(ImageFolderSource, MakesEightBitGreyOrBgrOfDeepAndTransparentPictures) {
  cv::Mat deep(4, 4, CV_16UC1, cv::Scalar(0x8000));
  cv::Mat transparent(4, 4, CV_8UC4, cv::Scalar(10, 20, 30, 7));
  const TemporaryFolder folder;
  folder.write("1.png", encoded(deep, ".png"));
  folder.write("2.png", encoded(transparent, ".png"));
  ImageFolderSource colour(folder.path(), false);
  EXPECT_EQ(next(colour).frame.image.data[0], 0x80);
  const Grabbed g = next(colour);
  EXPECT_EQ(g.frame.image.format, PixelFormat::bgr8);
  EXPECT_EQ(g.frame.image.data[2], 30);
  ImageFolderSource gray(folder.path(), true);
  const Grabbed h = next(gray);
  EXPECT_EQ(h.frame.image.format, PixelFormat::gray8);
  EXPECT_EQ(h.frame.image.data[0], 0x80);
}

// Cameras of 10 and 12 bits write them, and some of 7: white is what the header says it is.
TEST(ImageFolderSource, ScalesPgmAndPpmToTheirWhite) {
  const std::string comment = "\n# made in 1995 by a camera of 12 bits\n";
  const std::string half{1, static_cast<char>(0xff)};  // 511
  const std::string whole{3, static_cast<char>(0xff)};
  const std::string above{static_cast<char>(0xff), static_cast<char>(0xff)};
  const TemporaryFolder folder;
  folder.write("1.pgm", "P5" + comment + "3 1 1023\n" + half + whole + above);
  folder.write("2.ppm", "P6 1 1" + comment + "1023\n" + half + half + whole);
  folder.write("3.pgm", "P2 2 1 4095\n2048 4095\n");
  folder.write("4.pgm", "P5 2 1 255\n\x7f\xff");
  folder.write("5.pgm", "P5 2 1 65535\n\x7f\xff\xff\xff");
  folder.write("6.pgm", "P5 3 1 127\n\x3f\x7f\x80");
  folder.write("7.ppm", "P6 1 1 127\n\x3f\x3f\x7f");
  folder.write("8.pgm", "P2 2 1 127\n63 127\n");
  folder.write("9.pgm", "P5 3 1 1023\n" + half);
  for (const bool gray : {false, true}) {
    ImageFolderSource source(folder.path(), gray);
    for (const std::vector<int>& values : std::vector<std::vector<int>>{{127, 255, 255},
                                                                        {gray ? 142 : 255},
                                                                        {128, 255},
                                                                        {127, 255},
                                                                        {127, 255},
                                                                        {126, 255, 255},
                                                                        {gray ? 141 : 255},
                                                                        {126, 255}}) {
      const Grabbed g = next(source);
      ASSERT_EQ(g.grab, Grab::frame) << g.fault;
      EXPECT_EQ(g.frame.image.format, gray ? PixelFormat::gray8 : PixelFormat::bgr8);
      std::vector<int> got;
      for (std::size_t x = 0; x < values.size(); ++x)
        got.push_back(g.frame.image.data[x * (gray ? 1 : 3)]);
      EXPECT_EQ(got, values) << g.frame.index;
    }
    EXPECT_TRUE(says(next(source).fault, "9.pgm: the file is no readable picture"));
  }
}

TEST(ImageFolderSource, APictureThatCannotBeLookedAtKeepsItsNumber) {
  const TemporaryFolder folder;
  folder.write("2.png", encoded(textured(8, 8), ".png"));
  std::filesystem::create_symlink("1.png", folder.path() / "1.png");  // round and round
  ImageFolderSource source(folder.path(), false);
  EXPECT_TRUE(source.notes().empty());
  EXPECT_TRUE(says(next(source).fault, "1.png: the file is not there or cannot be read"));
  EXPECT_EQ(next(source).frame.index, 1U);
}

TEST(ImageFolderSource, NotesWhatIsLeftOutAndSizesThatDiffer) {
  const TemporaryFolder folder;
  folder.write("1.png", encoded(textured(8, 8), ".png"));
  folder.write("2.png", encoded(textured(8, 6), ".png"));
  ImageFolderSource clean(folder.path(), false);
  EXPECT_TRUE(clean.notes().empty());
  for (const char* name : {"truth.csv", ".hidden.png", "b.txt", "a.txt", ".m.csv.partial-7"})
    folder.write(name, "");
  std::filesystem::create_directory(folder.path() / "folder.png");
  ImageFolderSource source(folder.path(), false);
  ASSERT_EQ(source.notes().size(), 1U);
  EXPECT_EQ(source.notes()[0], "5 other files ignored: .hidden.png, a.txt, b.txt, ...");
  while (next(source).grab != Grab::end) {
  }
  ASSERT_EQ(source.notes().size(), 2U);
  EXPECT_EQ(source.notes()[1], "1 of 2 pictures differ in size from the first (8x8): 2.png (8x6)");
}

// Bad input: broken files between good ones.
TEST(ImageFolderSource, GoesOnAfterPicturesThatCannotBeRead) {
  const std::string jpeg = encoded(textured(64, 48), ".jpg");
  const std::string png = encoded(textured(64, 48), ".png");
  const std::string tiff = encoded(textured(64, 48), ".tif");
  const std::string bmp = encoded(textured(64, 48), ".bmp");
  const TemporaryFolder folder;
  folder.write("00.jpg", jpeg);
  folder.write("01.jpg", "");
  folder.write("02.jpg", jpeg.substr(0, jpeg.size() / 2));
  folder.write("03.png", png.substr(0, png.size() - 12));
  folder.write("04.png", "no picture");
  folder.write("05.tif", tiff.substr(0, tiff.size() / 2));
  folder.write("06.bmp", bmp.substr(0, bmp.size() / 2));
  folder.write("07.jpg", jpeg.substr(0, 3));
  std::filesystem::create_symlink(folder.path() / "nowhere", folder.path() / "08.jpg");
  folder.write("09.jpg", jpeg + "appended by the camera");
  ImageFolderSource source(folder.path(), false);
  EXPECT_EQ(next(source).grab, Grab::frame);
  for (const auto& [name, reason] :
       std::vector<std::pair<std::string, std::string>>{{"01.jpg", "empty"},
                                                        {"02.jpg", "truncated"},
                                                        {"03.png", "truncated"},
                                                        {"04.png", "no readable picture"},
                                                        {"05.tif", "no readable picture"},
                                                        {"06.bmp", "no readable picture"},
                                                        {"07.jpg", "truncated"},
                                                        {"08.jpg", "not there"}}) {
    const Grabbed g = next(source);
    EXPECT_EQ(g.grab, Grab::unreadable) << name;
    EXPECT_TRUE(says(g.fault, name));
    EXPECT_TRUE(says(g.fault, reason));
    EXPECT_EQ(g.frame.image.data, nullptr);
  }
  const Grabbed last = next(source);
  EXPECT_EQ(last.grab, Grab::frame);
  EXPECT_EQ(last.frame.index, 9U);
  EXPECT_EQ(next(source).grab, Grab::end);
}

// Bad input: a file of a few bytes that claims 40,000 x 40,000 pixels.
TEST(ImageFolderSource, RefusesDecompressionBombs) {
  std::string png = encoded(textured(8, 8), ".png");
  png.replace(16, 8, std::string("\0\0\x9c\x40\0\0\x9c\x40", 8));
  std::string jpeg = encoded(textured(8, 8), ".jpg");
  const std::size_t frame = jpeg.find("\xff\xc0");
  jpeg.replace(frame + 5, 4, "\x9c\x40\x9c\x40");
  const TemporaryFolder folder;
  folder.write("1.png", png);
  folder.write("2.jpg", jpeg);
  ImageFolderSource source(folder.path(), false);
  EXPECT_TRUE(says(next(source).fault, "1.png: the picture has more than"));
  EXPECT_TRUE(says(next(source).fault, "2.jpg: the picture has more than"));
}

// Bad input: folders that are none, or hold nothing.
TEST(ImageFolderSource, RefusesFoldersWithoutPictures) {
  const TemporaryFolder folder;
  EXPECT_TRUE(says(folder_error(folder.path() / "none"), "does not exist"));
  EXPECT_TRUE(says(folder_error(folder.write("truth.csv", "")), "is not a folder"));
  EXPECT_TRUE(says(folder_error(folder.path()), "holds no pictures, but truth.csv"));
}

// Bad input: a frame rate that gives no times.
TEST(ImageFolderSource, RefusesAFrameRateThatIsNotPositive) {
  const TemporaryFolder folder;
  folder.write("1.png", encoded(textured(8, 8), ".png"));
  for (const double rate : {0.0, -1.0, std::nan("")})
    EXPECT_TRUE(says(setup_error([&] { ImageFolderSource source(folder.path(), false, rate); }),
                     "frame rate"));
}

// Bad input: 300 seeded mutations of each format; a crash or a picture that is none fails.
TEST(ImageFolderSource, SurvivesMutatedPictures) {
  constexpr unsigned seed = 3;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (const std::string extension : {".jpg", ".png", ".bmp", ".ppm"}) {
    const TemporaryFolder folder;
    const std::string good = encoded(textured(32, 24), extension);
    for (int i = 0; i < 300; ++i)
      folder.write(std::to_string(i) + extension, test::mutated(good, random));
    ImageFolderSource source(folder.path(), false);
    ::testing::internal::CaptureStderr();  // libjpeg and libpng complain there by themselves
    int frames = 0;
    int unreadable = 0;
    for (Grabbed g = next(source); g.grab != Grab::end; g = next(source)) {
      if (g.grab == Grab::frame) {
        ++frames;
        EXPECT_GT(g.frame.image.width * g.frame.image.height, 0);
      } else {
        ++unreadable;
        EXPECT_FALSE(g.fault.empty());
      }
    }
    static_cast<void>(::testing::internal::GetCapturedStderr());
    EXPECT_EQ(frames + unreadable, 300) << extension;
    EXPECT_GT(unreadable, 10) << extension;
  }
}

}  // namespace
}  // namespace seqloop::opencv
