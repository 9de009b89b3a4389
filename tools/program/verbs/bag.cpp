// SPDX-License-Identifier: MIT
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "program/process/json_text.hpp"
#include "program/verbs/all_verbs.hpp"
#include "seqloop/bags/bag.hpp"
#include "seqloop/detail/counted.hpp"

namespace seqloop::program {
namespace {

struct BagSettings {
  std::vector<std::string> words;  // the task, and a file
  bool json = false;
};

double seconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-9; }

void print_json(const bags::BagFacts& facts, const std::vector<std::string>& notes) {
  nlohmann::ordered_json json;
  json["format"] = facts.format;
  json["start_ns"] = facts.start_ns;
  json["end_ns"] = facts.end_ns;
  json["topics"] = nlohmann::ordered_json::array();
  for (const bags::Topic& topic : facts.topics) {
    json["topics"].push_back({{"name", topic.name},
                              {"type", topic.type},
                              {"encoding", topic.encoding},
                              {"messages", topic.messages}});
  }
  json["notes"] = notes;
  // A bag's names may be no UTF-8.
  fmt::print("{}\n", json_text(json, 2));
}

void print_table(const bags::BagFacts& facts, const std::vector<std::string>& notes) {
  fmt::print("{}\n", facts.format);
  if (facts.end_ns > 0) {
    using Clock = std::chrono::system_clock;
    const auto start = Clock::time_point(
        std::chrono::duration_cast<Clock::duration>(std::chrono::nanoseconds(facts.start_ns)));
    fmt::print("from {:%Y-%m-%d %H:%M:%S} UTC, {:.3f} seconds\n", fmt::gmtime(start),
               seconds(facts.end_ns) - seconds(facts.start_ns));
  }
  std::size_t name = 5;
  std::size_t type = 4;
  for (const bags::Topic& topic : facts.topics) {
    name = std::max(name, topic.name.size());
    type = std::max(type, topic.type.size());
  }
  fmt::print("\n{:>12}  {:{}}  {:{}}  encoding\n", "messages", "topic", name, "type", type);
  for (const bags::Topic& topic : facts.topics) {
    fmt::print("{:>12}  {:{}}  {:{}}  {}\n", topic.messages, topic.name, name, topic.type, type,
               topic.encoding);
  }
  for (const std::string& note : notes) fmt::print("{}\n", note);
}

void tell_of_bag(const BagSettings& settings, Faults faults) {
  std::unique_ptr<bags::Bag> bag;
  const auto& words = settings.words;
  if (words.empty() || words[0] != "info") {
    faults.push_back({words.empty() ? "bag" : "'" + words[0] + "'",
                      words.empty() ? "what is to be done with it?" : "bags cannot do that",
                      "seqloop bag info FILE"});
  }
  if (words.size() == 2) {
    collect(faults, [&] { bag = bags::open_bag(words[1]); });
  } else if (!words.empty()) {
    faults.push_back({"bag " + words[0], counted(words.size() - 1, "name") + " after it",
                      "seqloop bag info FILE"});
  }
  refuse(std::move(faults));
  (settings.json ? print_json : print_table)(bag->facts(), bag->notes());
}

}  // namespace

Verb bag_verb() {
  const auto settings = std::make_shared<BagSettings>();
  Verb verb{"bag", "Say what a bag of ROS 2 holds: bag info FILE", {}, [settings](Faults faults) {
              tell_of_bag(*settings, std::move(faults));
            }};
  verb.options.section("Task");
  verb.options.flag("json", settings->json, "as JSON");
  verb.words = [settings](std::vector<std::string> words) { settings->words = std::move(words); };
  verb.tasks =
      "What it does:\n  seqloop bag info FILE [--json]   format, times and topics of .mcap, .db3, "
      "or a bag's folder";
  return verb;
}

}  // namespace seqloop::program
