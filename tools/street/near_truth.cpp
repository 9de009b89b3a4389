// SPDX-License-Identifier: MIT
// Which frames were taken near each other where roads meet.
#include <algorithm>
#include <cmath>
#include <utility>

#include "math.hpp"
#include "truth.hpp"

namespace seqloop::street {
namespace {

constexpr double kReach = 100.0;  // metres along the road, to both sides of a junction
constexpr double kStep = 0.5;     // metres between poses that are kept
constexpr double kAlike = kPi / 4.0;

struct Pose {
  double x, y, heading;
};

/// The centre line of a path, laid into the plane leg by leg. Where the camera is put elsewhere the
/// line goes on all the same; what lies on different sides of that must not be compared.
class CentreLine {
 public:
  explicit CentreLine(const Path& path) : path_(&path) {
    const auto count = static_cast<std::size_t>(path.length() / kStep) + 1;
    Pose pose{0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < count; ++i) {
      const double p = kStep * static_cast<double>(i);
      pose.heading = path.heading(path.leg_at(p), p);
      poses_.push_back(pose);
      const double middle = path.heading(path.leg_at(p + kStep / 2.0), p + kStep / 2.0);
      pose.x += kStep * std::cos(middle);
      pose.y += kStep * std::sin(middle);
    }
  }

  Pose at(double p) const {
    const auto i = std::min(static_cast<std::size_t>(p / kStep), poses_.size() - 1);
    const Pose& before = poses_[i];
    const double on = p - kStep * static_cast<double>(i);
    return {before.x + on * std::cos(before.heading), before.y + on * std::sin(before.heading),
            path_->heading(path_->leg_at(p), p)};
  }

 private:
  const Path* path_;
  std::vector<Pose> poses_;
};

struct Seen {
  std::size_t frame;
  Pose pose;
};

/// The frames within reach of path metre p that a road joins with it, seen from there. Headings are
/// absolute, so that what is seen from a junction on two of its roads lies in one plane.
std::vector<Seen> around(const Drive& drive, const CentreLine& line, std::size_t leg, double p) {
  const Path& path = drive.path();
  std::size_t first = leg;
  while (first > 0 && path.legs()[first].joined) --first;
  std::size_t end = leg + 1;
  while (end < path.legs().size() && path.legs()[end].joined) ++end;
  const double from = std::max(path.begin(first), p - kReach);
  const double to = std::min(path.begin(end), p + kReach);
  std::vector<Seen> seen;
  const Pose origin = line.at(p);
  for (std::size_t i = 0; i < drive.frames() && drive.position(i) <= to; ++i) {
    if (drive.position(i) < from) continue;
    const Pose pose = line.at(drive.position(i));
    seen.push_back({i, {pose.x - origin.x, pose.y - origin.y, pose.heading}});
  }
  return seen;
}

}  // namespace

std::vector<NearRow> near_truth(const Drive& drive, double metres) {
  const Path& path = drive.path();
  const std::vector<Leg>& legs = path.legs();
  const CentreLine line(path);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  const auto compare = [&](const Seen& a, const Seen& b) {
    const std::size_t newer = std::max(a.frame, b.frame);
    const std::size_t older = std::min(a.frame, b.frame);
    if (newer - older <= kLoopAge) return;
    // On one road the frames themselves are the truth.
    if (std::fabs(drive.street(newer) - drive.street(older)) <= 2.0 * metres) return;
    if (std::hypot(a.pose.x - b.pose.x, a.pose.y - b.pose.y) > metres) return;
    if (std::fabs(wrap_angle(a.pose.heading - b.pose.heading)) > kAlike) return;
    pairs.emplace_back(newer, older);
  };
  for (std::size_t k = 1; k < legs.size(); ++k) {
    if (!legs[k].joined) continue;
    const std::vector<Seen> here = around(drive, line, k, path.begin(k));
    // A junction is a place of both roads.
    for (const std::size_t road : {k - 1, k}) {
      const double s = road == k ? legs[k].start : legs[road].start + legs[road].length;
      for (std::size_t j = 0; j < legs.size(); ++j) {
        if (j == road || s < legs[j].start || s > legs[j].start + legs[j].length) continue;
        const double p = path.begin(j) + (s - legs[j].start);
        for (const Seen& other : around(drive, line, j, p)) {
          for (const Seen& own : here) compare(own, other);
        }
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<NearRow> rows;
  for (const auto& [query, frame] : pairs) {
    if (!rows.empty() && rows.back().query == query && rows.back().last + 1 == frame) {
      ++rows.back().last;
    } else {
      rows.push_back({query, frame, frame});
    }
  }
  return rows;
}

}  // namespace seqloop::street
