// SPDX-License-Identifier: MIT
#include "seqloop/dds/network.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "seqloop/fault.hpp"

namespace seqloop::dds {
namespace {

constexpr std::uint32_t most_domain = 232;  // the ports of higher ones do not exist

// 8K in four colours, and no more: what anybody may send is held in memory whole.
constexpr std::string_view limits =
    "<CycloneDDS><Domain><Internal><MaxSampleSize>134217728B</MaxSampleSize></Internal></Domain>"
    "</CycloneDDS>";

// As ROS 2's own layer for Cyclone DDS has them.
constexpr std::string_view humble_localhost =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/>"
    "</Interfaces></General></Domain></CycloneDDS>";
constexpr std::string_view iron_localhost =
    "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General><Discovery>"
    "<ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    "<Peers><Peer Address=\"localhost\"/></Peers></Discovery></Domain></CycloneDDS>";

std::string_view localhost(const Environment& environment, Faults& faults) {
  constexpr const char* range_name = "ROS_AUTOMATIC_DISCOVERY_RANGE";
  const auto text = [&](const char* name) -> std::string_view {
    const char* const value = environment(name);
    return value == nullptr ? std::string_view() : value;
  };
  const std::string_view range = text(range_name);
  // Newer ones still obey the older variable, and then ignore their own.
  if (text("ROS_LOCALHOST_ONLY") == "1") {
    const std::string_view distribution = text("ROS_DISTRO");
    const bool newer = !range.empty() || (!distribution.empty() && distribution != "humble");
    return newer ? iron_localhost : humble_localhost;
  }
  if (range == "LOCALHOST") return iron_localhost;
  if (range == "OFF") {
    faults.push_back({range_name, "is OFF: nobody can be found", "set it to LOCALHOST or SUBNET"});
  } else if (!range.empty() && range != "SUBNET" && range != "SYSTEM_DEFAULT") {
    faults.push_back({range_name, "'" + std::string(range) + "' is no range",
                      "SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT"});
  }
  return {};
}

/// Of the threads through which messages pass: the one that reads sockets (there are others
/// otherwise, which cannot be scheduled), the one that puts pieces together, and the one that asks
/// for lost ones again.
std::string scheduling(int priority) {
  std::string threads;
  for (const char* const name : {"recv", "dq.user", "tev"}) {
    threads += std::string("<Thread Name=\"") + name +
               "\"><Scheduling><Class>Realtime</Class><Priority>" + std::to_string(priority) +
               "</Priority></Scheduling></Thread>";
  }
  return "<CycloneDDS><Domain><Internal><MultipleReceiveThreads>false</MultipleReceiveThreads>"
         "</Internal><Threads>" +
         threads + "</Threads></Domain></CycloneDDS>";
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

Network network(const Environment& environment, int priority) {
  Network network;
  Faults faults;
  if (const char* const text = environment("ROS_DOMAIN_ID"); text != nullptr && *text != '\0') {
    const std::string_view number = text;
    const auto [end, error] =
        std::from_chars(number.data(), number.data() + number.size(), network.domain);
    if (error != std::errc() || end != number.data() + number.size() ||
        network.domain > most_domain) {
      faults.push_back({"ROS_DOMAIN_ID", "'" + std::string(number) + "' is no domain",
                        "a whole number from 0 to 232"});
    }
  }
  network.configuration = limits;
  if (priority > 0) network.configuration += "," + scheduling(priority);
  if (const std::string_view local = localhost(environment, faults); !local.empty()) {
    network.configuration += "," + std::string(local);
  }
  if (const char* const uri = environment("CYCLONEDDS_URI"); uri != nullptr && *uri != '\0') {
    network.configuration += "," + std::string(uri);
  }
  if (!faults.empty()) throw SetupError(std::move(faults));
  return network;
}

void check_topic(std::string_view topic, const std::string& flag) {
  const bool good =
      topic.size() > 1 && topic.front() == '/' && topic.back() != '/' &&
      std::ranges::all_of(topic, [](char c) { return is_letter(c) || is_digit(c) || c == '/'; });
  bool words = good;
  for (std::size_t i = 0; i + 1 < topic.size(); ++i) {
    words = words && (topic[i] != '/' || is_letter(topic[i + 1]));
  }
  if (words) return;
  throw SetupError({flag, "'" + std::string(topic) + "' is no topic of ROS 2",
                    "a topic is like /camera/image_raw: words of letters, digits and _"});
}

}  // namespace seqloop::dds
