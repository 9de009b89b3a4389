// SPDX-License-Identifier: MIT
#include "program/run/pose_graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "seqloop/detail/counted.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::program {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
// Of odometry, whose errors add up along the way: variances grow with the metres.
constexpr double odometry_metres = 0.05;           // after one metre
constexpr double odometry_radians = 0.5 * degree;  // likewise
constexpr double least_metres = 0.01;  // of a way: a robot that stands is not sure either
// How far views of one place turn.
constexpr double loop_radians = 5.0 * degree;

/// Of the two quaternions that are one orientation, the one with w >= 0: some readers take the
/// other for a turn of more than half a circle.
std::string numbers(const Pose& pose) {
  const auto& p = pose.position;
  auto q = pose.orientation;
  if (q[3] < 0.0) q = {0.0 - q[0], 0.0 - q[1], 0.0 - q[2], 0.0 - q[3]};
  return fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}", p[0], p[1], p[2], q[0],
                     q[1], q[2], q[3]);
}

/// The upper triangle of a diagonal information matrix: positions, then turns.
std::string information(double of_position, double of_turn) {
  std::string text;
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column)
      text += row == column ? fmt::format(" {:.6g}", row < 3 ? of_position : of_turn) : " 0";
  return text;
}

std::string edge(std::uint64_t from, std::uint64_t to, const Pose& motion, double of_position,
                 double of_turn) {
  return fmt::format("EDGE_SE3:QUAT {} {} {}{}\n", from, to, numbers(motion),
                     information(of_position, of_turn));
}

std::unique_ptr<files::OutputFile> opened(const std::filesystem::path& path) {
  if (path.empty()) return nullptr;
  return std::make_unique<files::OutputFile>(path);
}

}  // namespace

PoseGraph::PoseGraph(const std::filesystem::path& file, const std::filesystem::path& trajectory)
    : graph_(opened(file)), trajectory_(opened(trajectory)) {}

void PoseGraph::begin(Odometry odometry, double start_s, std::size_t sequence) {
  odometry_ = std::move(odometry);
  start_s_ = start_s;
  sequence_ = sequence;
}

void PoseGraph::add(std::uint64_t frame, double time_s) {
  if (const std::optional<Pose> pose = odometry_->at(time_s)) {
    vertices_.push_back({frame, time_s, *pose});
  } else {
    ++(time_s > odometry_->first_s() && time_s < odometry_->last_s() ? in_gaps_ : without_pose_);
  }
}

void PoseGraph::add(std::span<const Answer> answers) {
  for (const Answer& answer : answers) {
    if (answer.gate != Gate::match || !answer.match) continue;
    // By uniqueness there is no probability; who accepts it then stands by it all the same.
    const auto probability = static_cast<double>(answer.probability);
    loops_.push_back(
        {answer.frame, answer.match->place, std::isnan(probability) ? 1.0 : probability});
  }
}

std::vector<std::string> PoseGraph::notes() const {
  const auto edges = static_cast<std::uint64_t>(
      std::ranges::count_if(loops_, [&](const Loop& loop) { return has_poses(loop); }));
  std::vector<std::string> lines{
      fmt::format("pose graph: {}, {}", counted(vertices_.size(), "pose"), counted(edges, "loop"))};
  if (const std::uint64_t without = loops_.size() - edges; without > 0)
    lines.push_back(fmt::format("{} {} left out of it for lack of a pose", counted(without, "loop"),
                                are(without)));
  if (without_pose_ > 0)
    lines.push_back("no pose: " + counted(without_pose_, "frame") +
                    " outside of the odometry's times");
  if (in_gaps_ > 0)
    lines.push_back(
        fmt::format("no pose: {} between two poses of the odometry that are more than {} s apart",
                    counted(in_gaps_, "frame"), Odometry::most_gap_s));
  if (odometry_ && odometry_->left_out() > 0)
    lines.push_back(
        fmt::format("left out of the odometry: {} that is none, or whose stamp does not rise",
                    counted(odometry_->left_out(), "pose")));
  return lines;
}

void PoseGraph::commit(Attempts& attempt) {
  if (vertices_.empty()) {
    attempt.fail(Fault{"odometry", "no frame of the drive lies within its times",
                       "its times must be those of the drive: a bag's stamps, or seconds from its "
                       "first frame"});
    return;
  }
  if (graph_) attempt([this] { write_graph(); });
  if (trajectory_) attempt([this] { write_trajectory(); });
}

bool PoseGraph::has_poses(const Loop& loop) const noexcept {
  return vertex(loop.frame) != nullptr && vertex(loop.match) != nullptr;
}

const PoseGraph::Vertex* PoseGraph::vertex(std::uint64_t frame) const noexcept {
  const auto found = std::ranges::lower_bound(vertices_, frame, {}, &Vertex::frame);
  return found == vertices_.end() || found->frame != frame ? nullptr : &*found;
}

/// How far the robot goes from one frame to the next, in the middle of all; halts do not count.
double PoseGraph::metres_a_frame() const {
  std::vector<double> ways;
  for (std::size_t i = 1; i < vertices_.size(); ++i) {
    const double way = metres(motion(vertices_[i - 1].pose, vertices_[i].pose));
    const auto frames = static_cast<double>(vertices_[i].frame - vertices_[i - 1].frame);
    if (way > least_metres) ways.push_back(way / frames);
  }
  if (ways.empty()) return least_metres;
  const auto middle = ways.begin() + static_cast<std::ptrdiff_t>(ways.size() / 2);
  std::ranges::nth_element(ways, middle);
  return *middle;
}

void PoseGraph::write_graph() {
  graph_->write("# SeqLoop: a vertex a frame, by odometry; loops have no known offset\n");
  for (const Vertex& vertex : vertices_)
    graph_->write(fmt::format("VERTEX_SE3:QUAT {} {}\n", vertex.frame, numbers(vertex.pose)));
  graph_->write(fmt::format("FIX {}\n", vertices_.front().frame));
  for (std::size_t i = 1; i < vertices_.size(); ++i) {
    const Pose way = motion(vertices_[i - 1].pose, vertices_[i].pose);
    const double length = std::max(metres(way), least_metres);
    graph_->write(edge(vertices_[i - 1].frame, vertices_[i].frame, way,
                       1.0 / (odometry_metres * odometry_metres * length),
                       1.0 / (odometry_radians * odometry_radians * length)));
  }
  const double off = static_cast<double>(loop_frames) * metres_a_frame();
  for (const Loop& loop : loops_) {
    if (!has_poses(loop)) continue;
    const double weight = loop.probability / static_cast<double>(sequence_);
    graph_->write(edge(loop.match, loop.frame, Pose{}, weight / (off * off),
                       weight / (loop_radians * loop_radians)));
  }
  graph_->commit();
}

void PoseGraph::write_trajectory() {
  trajectory_->write("# time x y z qx qy qz qw\n");
  for (const Vertex& vertex : vertices_)
    trajectory_->write(fmt::format("{:.9f} {}\n", start_s_ + vertex.time_s, numbers(vertex.pose)));
  trajectory_->commit();
}

}  // namespace seqloop::program
