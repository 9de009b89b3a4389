// SPDX-License-Identifier: MIT
#include "program/run/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "seqloop/detail/counted.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/files/output_file.hpp"
#include "seqloop/opencv/file_codecs.hpp"

namespace seqloop::program {
namespace {

constexpr std::size_t most_columns = 1000;
constexpr int plot_size = 900;  // pixels
constexpr int margin = 70;
const cv::Scalar ink(40, 40, 40);
const cv::Scalar match_colour(40, 40, 230);
const cv::Scalar border_colour(200, 120, 40);  // of sessions

void write_png(const std::filesystem::path& file, const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  opencv::file_codecs().encode(".png", picture, bytes);
  files::OutputFile out(file);
  out.write(std::as_bytes(std::span(bytes)));
  out.commit();
}

void write_text(cv::Mat& picture, const std::string& text, cv::Point where, double size = 0.5) {
  cv::putText(picture, text, where, cv::FONT_HERSHEY_SIMPLEX, size, ink, 1, cv::LINE_AA);
}

/// A size at which the text is no wider than that, as far as it can be read then.
double fitting(const std::string& text, int width) {
  constexpr double usual = 0.5;
  constexpr double least = 0.3;
  const int needed = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, usual, 1, nullptr).width;
  return std::clamp(usual * width / std::max(needed, 1), least, usual);
}

/// Stretches the middle 98 % of the differences over all greys: dark is alike.
cv::Mat to_greys(const cv::Mat& differences) {
  std::vector<float> sorted(differences.begin<float>(), differences.end<float>());
  std::ranges::sort(sorted);
  const float low = sorted[sorted.size() / 100];
  const float high = sorted[sorted.size() - 1 - sorted.size() / 100];
  const double scale = high > low ? 255.0 / static_cast<double>(high - low) : 1.0;
  cv::Mat greys;
  differences.convertTo(greys, CV_8U, scale, -static_cast<double>(low) * scale);
  return greys;
}

/// @param name_of what a column or row is called, 0 .. last
void draw_axis(cv::Mat& picture, bool horizontal, std::uint64_t last,
               const std::function<std::uint64_t(std::uint64_t)>& name_of) {
  constexpr int ticks = 5;
  for (int tick = 0; tick <= ticks; ++tick) {
    const std::uint64_t value = name_of(last * static_cast<std::uint64_t>(tick) / ticks);
    const int along = plot_size * tick / ticks;
    const cv::Point at = horizontal ? cv::Point(margin + along, margin / 2 + plot_size)
                                    : cv::Point(margin, margin / 2 + plot_size - along);
    cv::line(picture, at, at + (horizontal ? cv::Point(0, 5) : cv::Point(-5, 0)), ink);
    const std::string text = std::to_string(value);
    const int width = static_cast<int>(text.size()) * 9;
    write_text(picture, text,
               at + (horizontal ? cv::Point(-width / 2, 20) : cv::Point(-width - 8, 4)), 0.45);
  }
}

/// By number, small and in colour.
using Pictures = std::map<std::uint64_t, cv::Mat>;

cv::Mat small(const cv::Mat& picture, cv::InterpolationFlags how) {
  constexpr int width = 320;
  cv::Mat resized;
  cv::resize(picture, resized, {width, std::max(1, picture.rows * width / picture.cols)}, 0, 0,
             how);
  return resized;
}

/// Frames of a drive by index.
Pictures fetch(FrameSource& source, std::vector<std::uint64_t> wanted) {
  std::ranges::sort(wanted);
  Pictures found;
  Frame frame;
  for (Grab grab = source.grab(frame); grab != Grab::end && !wanted.empty();
       grab = source.grab(frame)) {
    if (frame.index > wanted.back()) break;
    if (grab != Grab::frame || !std::ranges::binary_search(wanted, frame.index)) continue;
    const Image& image = frame.image;
    if (image.data == nullptr) break;
    const bool gray = image.format == PixelFormat::gray8;
    // cv::Mat has no view of constant pixels; this one is only read.
    const cv::Mat view(image.height, image.width, gray ? CV_8UC1 : CV_8UC3,
                       const_cast<std::uint8_t*>(image.data), image.stride);
    cv::Mat& picture = found[frame.index] = small(view, cv::INTER_AREA);
    if (gray) cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
  }
  return found;
}

std::string how_sure(const Answer& answer) {
  return std::isnan(answer.probability) ? fmt::format("uniqueness {:.2f}", answer.match->uniqueness)
                                        : fmt::format("probability {:.3f}", answer.probability);
}

/// Frames and their places side by side, in `matches.png`. @return false when there are none
bool write_sheet(const std::filesystem::path& folder, const std::vector<Answer>& chosen,
                 const Pictures& seen, const Pictures& known,
                 const std::function<std::string(std::uint64_t)>& name_of) {
  // All pairs get the room of the tallest picture, so that a drive of mixed sizes fits the sheet.
  int height = 0;
  for (const auto& pictures : {seen, known}) {
    for (const auto& [frame, picture] : pictures) height = std::max(height, picture.rows);
  }
  std::vector<cv::Mat> pairs;
  for (const Answer& answer : chosen) {
    const auto left = seen.find(answer.frame);
    const auto right = known.find(answer.match->place);
    if (left == seen.end() || right == known.end()) continue;
    constexpr int caption = 24;
    constexpr int gap = 6;
    cv::Mat pair(height + caption + gap, left->second.cols + right->second.cols + 3 * gap, CV_8UC3,
                 cv::Scalar::all(255));
    left->second.copyTo(pair(cv::Rect({gap, caption}, left->second.size())));
    right->second.copyTo(
        pair(cv::Rect({left->second.cols + 2 * gap, caption}, right->second.size())));
    write_text(pair, fmt::format("frame {}", answer.frame), {gap, caption - 7});
    const std::string said = fmt::format("{}, {}", name_of(answer.match->place), how_sure(answer));
    write_text(pair, said, {left->second.cols + 2 * gap, caption - 7},
               fitting(said, right->second.cols));
    pairs.push_back(pair);
  }
  if (pairs.empty()) {
    // One of an earlier run would stand beside this one's matrix.
    std::filesystem::remove(folder / sheet_name);
    return false;
  }
  // Two columns of equal pairs; an odd one is completed with white.
  cv::Mat sheet;
  for (std::size_t i = 0; i < pairs.size(); i += 2) {
    cv::Mat right(pairs[i].size(), CV_8UC3, cv::Scalar::all(255));
    if (i + 1 < pairs.size()) right = pairs[i + 1];
    cv::Mat row;
    cv::hconcat(pairs[i], right, row);
    sheet.push_back(row);
  }
  write_png(folder / sheet_name, sheet);
  return true;
}

}  // namespace

void PictureRecorder::add(std::span<const Answer> answers) {
  std::ranges::copy_if(answers, std::back_inserter(matches_), [](const Answer& answer) {
    return answer.gate == Gate::match && answer.match;
  });
}

void PictureRecorder::add(std::uint64_t frame, std::span<const float> query) {
  if (frame % step_ != 0) return;
  queries_.emplace_back(query.begin(), query.end());
  if (queries_.size() < most_columns) return;
  for (std::size_t i = 0; 2 * i < queries_.size(); ++i) std::swap(queries_[i], queries_[2 * i]);
  queries_.resize((queries_.size() + 1) / 2);
  step_ *= 2;
}

void PictureRecorder::write_matrix(const std::filesystem::path& folder, const PlaceMap& map) const {
  if (queries_.empty() || map.size() == 0) return;
  const std::size_t rows = std::min(map.size(), most_columns);
  const auto place_of = [&](std::size_t row) { return row * map.size() / rows; };
  cv::Mat differences(static_cast<int>(rows), static_cast<int>(queries_.size()), CV_32F);
  std::vector<float> place(map.rows().restored_size());
  for (std::size_t row = 0; row < rows; ++row) {
    map.rows().restore(map.order().slot(place_of(row)), place);
    for (std::size_t column = 0; column < queries_.size(); ++column) {
      differences.at<float>(static_cast<int>(rows - 1 - row), static_cast<int>(column)) =
          difference(difference_, queries_[column], place, map.descriptor_size());
    }
  }
  cv::Mat plot;
  const bool shrinks = rows > plot_size;
  cv::resize(to_greys(differences), plot, {plot_size, plot_size}, 0, 0,
             shrinks ? cv::INTER_AREA : cv::INTER_NEAREST);

  cv::Mat picture(plot_size + margin + margin / 2, plot_size + margin + margin / 2, CV_8UC3,
                  cv::Scalar::all(255));
  cv::Mat inside = picture(cv::Rect(margin, margin / 2, plot_size, plot_size));
  cv::cvtColor(plot, inside, cv::COLOR_GRAY2BGR);
  const auto frames = static_cast<double>(queries_.size() * step_);
  const auto height_of = [&map](std::size_t row) {
    const double y = static_cast<double>(row) / static_cast<double>(map.size());
    return plot_size - static_cast<int>(y * plot_size);
  };
  for (std::size_t session = 1; session < map.order().sessions(); ++session) {
    const int y = height_of(map.order().session(session).first);
    cv::line(inside, {0, y}, {plot_size, y}, border_colour);
  }
  for (const Answer& answer : matches_) {
    const auto row = map.order().row_of_number(answer.match->place);
    if (!row) continue;
    const double x = static_cast<double>(answer.frame) / frames;
    cv::circle(inside, {static_cast<int>(x * plot_size), height_of(*row)}, 2, match_colour,
               cv::FILLED, cv::LINE_AA);
  }
  draw_axis(picture, true, queries_.size() * step_, [](std::uint64_t frame) { return frame; });
  // Numbers of places, which have gaps where a robot stood.
  draw_axis(picture, false, map.size(), [&](std::uint64_t row) {
    const PlaceOrder& order = map.order();
    return row < map.size() ? order.number(static_cast<std::size_t>(row))
                            : order.number(map.size() - 1) + 1;
  });
  write_text(picture,
             "places over frames; dark: alike; red: " + counted(matches_.size(), "match", "es"),
             {margin, margin / 2 - 12});
  write_png(folder / matrix_name, picture);
}

/// Up to ten matches, evenly over the drive.
std::vector<Answer> PictureRecorder::chosen() const {
  constexpr std::size_t most_pairs = 10;
  const std::size_t count = std::min(most_pairs, matches_.size());
  std::vector<Answer> some;
  for (std::size_t i = 0; i < count; ++i) {
    some.push_back(matches_[(2 * i + 1) * matches_.size() / (2 * count)]);
  }
  return some;
}

bool PictureRecorder::write_pairs(const std::filesystem::path& folder, const Reopen& query,
                                  const Reopen& reference) const {
  const std::vector<Answer> some = chosen();
  std::vector<std::uint64_t> frames;
  std::vector<std::uint64_t> places;
  for (const Answer& answer : some) {
    frames.push_back(answer.frame);
    places.push_back(answer.match->place);
  }
  const auto name = [](std::uint64_t place) { return fmt::format("is place {}", place); };
  return write_sheet(folder, some, fetch(*query(), std::move(frames)),
                     fetch(*reference(), std::move(places)), name);
}

bool PictureRecorder::write_pairs(const std::filesystem::path& folder, const Reopen& query,
                                  const LastingMap& map, const std::string& own) const {
  const std::vector<Answer> some = chosen();
  const auto own_frame = [&](const Answer& answer) -> std::optional<std::uint64_t> {
    const LastingMap::Seen seen = map.where(answer.match->place);
    return !own.empty() && seen.session == own ? seen.frame : std::nullopt;
  };
  std::vector<std::uint64_t> frames;
  for (const Answer& answer : some) {
    frames.push_back(answer.frame);
    if (const auto frame = own_frame(answer)) frames.push_back(*frame);
  }
  const Pictures seen = fetch(*query(), std::move(frames));
  const std::unique_ptr<PlacePictures> pictures = map.pictures();
  Pictures known;
  for (const Answer& answer : some) {
    const auto frame = own_frame(answer);
    if (const auto its = frame ? seen.find(*frame) : seen.end(); its != seen.end()) {
      known[answer.match->place] = its->second;
      continue;
    }
    const std::string jpeg = pictures->jpeg(answer.match->place);
    if (jpeg.empty()) continue;
    const std::vector<std::uint8_t> bytes(jpeg.begin(), jpeg.end());
    const cv::Mat thumbnail = opencv::file_codecs().decode(bytes, cv::IMREAD_COLOR);
    if (!thumbnail.empty()) known[answer.match->place] = small(thumbnail, cv::INTER_LINEAR);
  }
  const auto name = [&map](std::uint64_t place) {
    const LastingMap::Seen where = map.where(place);
    return where.frame ? fmt::format("is {} of {}", *where.frame, where.session)
                       : fmt::format("is place {}", place);
  };
  return write_sheet(folder, some, seen, known, name);
}

}  // namespace seqloop::program
