// SPDX-License-Identifier: MIT
#include "seqloop/bags/odometry.hpp"

#include <algorithm>
#include <memory>
#include <string_view>

#include "seqloop/bags/bag.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::bags {
namespace {

bool is_odometry(std::string_view type) {
  return type == "nav_msgs/msg/Odometry" || type == "nav_msgs/Odometry";
}

}  // namespace

std::vector<ros::OdometryPose> read_odometry(const std::filesystem::path& path,
                                             const std::string& name) {
  const std::unique_ptr<Bag> bag = open_bag(path);
  const std::vector<Topic>& topics = bag->facts().topics;
  const auto topic = std::ranges::find(topics, name, &Topic::name);
  if (topic == topics.end() || !is_odometry(topic->type) || topic->encoding != "cdr") {
    std::string others;
    for (const Topic& other : topics)
      if (is_odometry(other.type)) others += (others.empty() ? "" : ", ") + other.name;
    throw SetupError(Fault{path.string(), "has no topic " + name + " of nav_msgs/msg/Odometry",
                           others.empty() ? "give a file of poses (TUM)" : "there is " + others});
  }
  std::vector<ros::OdometryPose> poses;
  bag->choose(name);
  Message message;
  for (Read read = bag->next(message); read != Read::end; read = bag->next(message)) {
    if (read == Read::damaged) continue;
    if (const auto pose = ros::read_odometry(message.bytes)) poses.push_back(*pose);
  }
  return poses;
}

}  // namespace seqloop::bags
