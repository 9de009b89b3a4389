// SPDX-License-Identifier: MIT
#include "program/run/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "seqloop/difference.hpp"
#include "seqloop/files/output_file.hpp"

namespace seqloop::program {
namespace {

constexpr std::size_t most_columns = 1000;
constexpr int plot_size = 900;  // pixels
constexpr int margin = 70;
const cv::Scalar ink(40, 40, 40);
const cv::Scalar match_colour(40, 40, 230);

void write_png(const std::filesystem::path& file, const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", picture, bytes);
  files::OutputFile out(file);
  out.write(std::as_bytes(std::span(bytes)));
  out.commit();
}

void write_text(cv::Mat& picture, const std::string& text, cv::Point where, double size = 0.5) {
  cv::putText(picture, text, where, cv::FONT_HERSHEY_SIMPLEX, size, ink, 1, cv::LINE_AA);
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

void draw_axis(cv::Mat& picture, bool horizontal, std::uint64_t last) {
  constexpr int ticks = 5;
  for (int tick = 0; tick <= ticks; ++tick) {
    const std::uint64_t value = last * static_cast<std::uint64_t>(tick) / ticks;
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

/// Frames of a drive by index, as small colour pictures.
std::map<std::uint64_t, cv::Mat> fetch(FrameSource& source, std::vector<std::uint64_t> wanted) {
  constexpr int width = 320;
  std::ranges::sort(wanted);
  std::map<std::uint64_t, cv::Mat> found;
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
    cv::Mat& small = found[frame.index];
    cv::resize(view, small, {width, std::max(1, image.height * width / image.width)}, 0, 0,
               cv::INTER_AREA);
    if (gray) cv::cvtColor(small, small, cv::COLOR_GRAY2BGR);
  }
  return found;
}

std::string how_sure(const Answer& answer) {
  return std::isnan(answer.probability) ? fmt::format("uniqueness {:.2f}", answer.match->uniqueness)
                                        : fmt::format("probability {:.3f}", answer.probability);
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
  for (const Answer& answer : matches_) {
    const double x = static_cast<double>(answer.frame) / frames;
    const double y = static_cast<double>(answer.match->place) / static_cast<double>(map.size());
    cv::circle(inside,
               {static_cast<int>(x * plot_size), plot_size - static_cast<int>(y * plot_size)}, 2,
               match_colour, cv::FILLED, cv::LINE_AA);
  }
  draw_axis(picture, true, queries_.size() * step_);
  draw_axis(picture, false, map.size());
  write_text(picture,
             fmt::format("places over frames; dark: alike; red: {} matches", matches_.size()),
             {margin, margin / 2 - 12});
  write_png(folder / "difference_matrix.png", picture);
}

bool PictureRecorder::write_pairs(const std::filesystem::path& folder, const Reopen& query,
                                  const Reopen& reference) const {
  constexpr std::size_t most_pairs = 10;
  const std::size_t count = std::min(most_pairs, matches_.size());
  std::vector<Answer> chosen;
  std::vector<std::uint64_t> frames;
  std::vector<std::uint64_t> places;
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(matches_[(2 * i + 1) * matches_.size() / (2 * count)]);
    frames.push_back(chosen.back().frame);
    places.push_back(chosen.back().match->place);
  }
  const auto seen = fetch(*query(), frames);
  const auto known = fetch(*reference(), places);

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
    write_text(pair, fmt::format("is place {}, {}", answer.match->place, how_sure(answer)),
               {left->second.cols + 2 * gap, caption - 7});
    pairs.push_back(pair);
  }
  if (pairs.empty()) return false;
  // Two columns of equal pairs; an odd one is completed with white.
  cv::Mat sheet;
  for (std::size_t i = 0; i < pairs.size(); i += 2) {
    cv::Mat right(pairs[i].size(), CV_8UC3, cv::Scalar::all(255));
    if (i + 1 < pairs.size()) right = pairs[i + 1];
    cv::Mat row;
    cv::hconcat(pairs[i], right, row);
    sheet.push_back(row);
  }
  write_png(folder / "matches.png", sheet);
  return true;
}

}  // namespace seqloop::program
