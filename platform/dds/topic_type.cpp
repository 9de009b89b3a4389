// SPDX-License-Identifier: MIT
#include "dds/topic_type.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "dds/idl/ros2.h"
#include "dds/idl/seqloop_msgs.h"

namespace seqloop::dds {
namespace {

// tests/ros/types.py computes the hashes from the definitions.
const std::array all_types{
    TopicType{"sensor_msgs/msg/Image",
              "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
              &sensor_msgs_msg_dds__Image__desc},
    TopicType{"sensor_msgs/msg/CompressedImage",
              "RIHS01_15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a",
              &sensor_msgs_msg_dds__CompressedImage__desc},
    TopicType{"nav_msgs/msg/Odometry",
              "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
              &nav_msgs_msg_dds__Odometry__desc},
    TopicType{"diagnostic_msgs/msg/DiagnosticArray",
              "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
              &diagnostic_msgs_msg_dds__DiagnosticArray__desc},
    TopicType{"seqloop_msgs/msg/LoopClosure",
              "RIHS01_e49cbbc048ec3f8519ca655ac747936765647a74617218a8bf1e9d438d886273",
              &seqloop_msgs_msg_dds__LoopClosure__desc},
    TopicType{"seqloop_msgs/msg/Status",
              "RIHS01_5d6c7c581c4ad2ee0f19d3b7c490e1b9d07fbdd02be1ae5b5b83b137f0e9fa3b",
              &seqloop_msgs_msg_dds__Status__desc},
};

}  // namespace

std::span<const TopicType> topic_types() noexcept { return all_types; }

const TopicType& topic_type(std::string_view name) {
  const auto found = std::ranges::find(all_types, name, &TopicType::name);
  if (found == all_types.end()) throw std::out_of_range(std::string(name));
  return *found;
}

std::string wire_name(std::string_view topic) { return "rt" + std::string(topic); }

std::string ros_type(std::string_view wire_type) {
  constexpr std::string_view middle = "::msg::dds_::";
  const std::size_t at = wire_type.find(middle);
  if (at == std::string_view::npos || !wire_type.ends_with('_')) return std::string(wire_type);
  std::string_view name = wire_type.substr(at + middle.size());
  name.remove_suffix(1);
  return std::string(wire_type.substr(0, at)) + "/msg/" + std::string(name);
}

}  // namespace seqloop::dds
