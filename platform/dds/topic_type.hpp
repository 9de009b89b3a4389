// SPDX-License-Identifier: MIT
#pragma once

#include <dds/dds.h>

#include <span>
#include <string>
#include <string_view>

namespace seqloop::dds {

/// A type of ROS 2 as DDS knows it.
struct TopicType {
  std::string_view name;  ///< `sensor_msgs/msg/Image`
  std::string_view hash;  ///< `RIHS01_...`, by which ROS 2 compares definitions from Iron on
  const dds_topic_descriptor_t* descriptor;
};

/// All that is read or sent.
[[nodiscard]] std::span<const TopicType> topic_types() noexcept;

/// @param name `sensor_msgs/msg/Image`. Throws std::out_of_range: none of `topic_types`.
[[nodiscard]] const TopicType& topic_type(std::string_view name);

/// `rt/camera/image_raw` of `/camera/image_raw`: how DDS knows a topic of ROS 2.
[[nodiscard]] std::string wire_name(std::string_view topic);

/// `sensor_msgs/msg/Image` of `sensor_msgs::msg::dds_::Image_`; another name as it is.
[[nodiscard]] std::string ros_type(std::string_view wire_type);

}  // namespace seqloop::dds
