// SPDX-License-Identifier: MIT
#include "seqloop/dds/network.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>

#include "expect_setup_error.hpp"

namespace seqloop::dds {
namespace {

Network of(const std::map<std::string, std::string>& variables) {
  return network([&](const char* name) -> const char* {
    const auto found = variables.find(name);
    return found == variables.end() ? nullptr : found->second.c_str();
  });
}

bool says(const Network& network, const std::string& words) {
  return network.configuration.find(words) != std::string::npos;
}

TEST(Network, WithoutVariablesItIsDomain0OfTheWholeSubnet) {
  const Network network = of({});
  EXPECT_EQ(network.domain, 0U);
  EXPECT_TRUE(says(network, "MaxSampleSize"));
  EXPECT_FALSE(says(network, "127.0.0.1"));
  EXPECT_FALSE(says(network, "AllowMulticast"));
}

TEST(Network, WhatReceivesIsScheduledAsAsked) {
  EXPECT_FALSE(says(of({}), "Scheduling"));
  const Network network = seqloop::dds::network([](const char*) { return nullptr; }, 81);
  EXPECT_TRUE(says(network,
                   "<Thread Name=\"recv\"><Scheduling><Class>Realtime</Class><Priority>81</"
                   "Priority></Scheduling></Thread>"));
  const Network overridden = seqloop::dds::network(
      [](const char* name) {
        return std::string_view(name) == "CYCLONEDDS_URI" ? "<CycloneDDS/>" : nullptr;
      },
      81);
  EXPECT_TRUE(overridden.configuration.ends_with(",<CycloneDDS/>")) << "the user's word is last";
}

TEST(Network, Domain) {
  EXPECT_EQ(of({{"ROS_DOMAIN_ID", "42"}}).domain, 42U);
  EXPECT_EQ(of({{"ROS_DOMAIN_ID", ""}}).domain, 0U);
  EXPECT_EQ(of({{"ROS_DOMAIN_ID", "232"}}).domain, 232U);
  for (const char* const bad : {"233", "-1", "4 2", "x", "99999999999"}) {
    EXPECT_EQ(
        test::setup_error([&] {
          of({{"ROS_DOMAIN_ID", bad}});
        }),
        "ROS_DOMAIN_ID: '" + std::string(bad) + "' is no domain; a whole number from 0 to 232");
  }
}

TEST(Network, StaysOnThisMachineAsHumbleOrAsIronHaveIt) {
  const char* const range = "ROS_AUTOMATIC_DISCOVERY_RANGE";
  EXPECT_TRUE(says(of({{"ROS_LOCALHOST_ONLY", "1"}}), "address=\"127.0.0.1\""));
  EXPECT_FALSE(says(of({{"ROS_LOCALHOST_ONLY", "0"}}), "127.0.0.1"));
  const auto is_iron = [](const Network& network) {
    return says(network, "AllowMulticast>false") && says(network, "Peer Address=\"localhost\"") &&
           !says(network, "address=\"127.0.0.1\"");
  };
  EXPECT_TRUE(is_iron(of({{range, "LOCALHOST"}})));
  // Who has the newer variable, or a newer ROS 2, speaks with others as newer ones do.
  for (const char* const value : {"LOCALHOST", "SUBNET", "SYSTEM_DEFAULT", "OFF"}) {
    EXPECT_TRUE(is_iron(of({{range, value}, {"ROS_LOCALHOST_ONLY", "1"}}))) << value;
  }
  EXPECT_TRUE(is_iron(of({{"ROS_DISTRO", "jazzy"}, {"ROS_LOCALHOST_ONLY", "1"}})));
  EXPECT_TRUE(
      says(of({{"ROS_DISTRO", "humble"}, {"ROS_LOCALHOST_ONLY", "1"}}), "address=\"127.0.0.1\""));
  EXPECT_FALSE(is_iron(of({{range, "SUBNET"}, {"ROS_LOCALHOST_ONLY", "0"}})));
  EXPECT_EQ(test::setup_error([&] {
              of({{range, "OFF"}, {"ROS_DOMAIN_ID", "x"}});
            }),
            "ROS_DOMAIN_ID: 'x' is no domain; a whole number from 0 to 232\n"
            "ROS_AUTOMATIC_DISCOVERY_RANGE: is OFF: nobody can be found; "
            "set it to LOCALHOST or SUBNET");
}

TEST(Network, CyclonesOwnConfigurationComesLast) {
  const Network network =
      of({{"CYCLONEDDS_URI", "file:///etc/cyclone.xml"}, {"ROS_LOCALHOST_ONLY", "1"}});
  EXPECT_TRUE(network.configuration.ends_with(",file:///etc/cyclone.xml"));
}

TEST(Network, NamesOfTopics) {
  for (const char* const good : {"/a", "/camera/image_raw", "/_x/y2"}) check_topic(good, "source");
  for (const char* const bad : {"", "/", "camera", "/a/", "//a", "/a//b", "/2a", "/a b", "/a-b"}) {
    EXPECT_EQ(test::setup_error([&] { check_topic(bad, "source"); }),
              "source: '" + std::string(bad) +
                  "' is no topic of ROS 2; a topic is like /camera/image_raw: words of letters, "
                  "digits and _");
  }
}

}  // namespace
}  // namespace seqloop::dds
