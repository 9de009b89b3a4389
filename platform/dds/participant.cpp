// SPDX-License-Identifier: MIT
#include "seqloop/dds/participant.hpp"

#include <dds/dds.h>

#include <map>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include "dds/entity.hpp"
#include "dds/topic_type.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::dds {

/// Takes what Cyclone DDS has to say, which would go to stderr otherwise. It tells of a message
/// that is none of its type, or too large, nowhere else.
class Participant::Log {
 public:
  Log() { dds_set_log_sink(&Log::take, this); }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;
  Log(Log&&) = delete;
  Log& operator=(Log&&) = delete;
  ~Log() { dds_set_log_sink(nullptr, nullptr); }

  [[nodiscard]] std::string last_words() const {
    const std::scoped_lock lock(mutex_);
    return last_;
  }

  [[nodiscard]] std::uint64_t refused(const std::string& wire_name) const {
    const std::scoped_lock lock(mutex_);
    const auto found = refused_.find(wire_name);
    return found == refused_.end() ? 0 : found->second;
  }

 private:
  /// "data(...): deserialization TOPIC/TYPE failed (...)",
  /// "dropping oversize (...) sample ... from remote writer ... TOPIC/TYPE"
  static void take(void* self, const dds_log_data_t* line) {
    constexpr std::size_t most_topics = 64;  // anybody may send to any topic that is read
    auto& log = *static_cast<Log*>(self);
    std::string_view text(line->message, line->size);
    while (text.ends_with('\n')) text.remove_suffix(1);
    const std::scoped_lock lock(log.mutex_);
    log.last_ = text;
    const bool refuses = text.find(": deserialization ") != std::string_view::npos ||
                         text.starts_with("dropping oversize ");
    const std::size_t at = text.find(" rt/");
    if (!refuses || at == std::string_view::npos || log.refused_.size() == most_topics) return;
    text.remove_prefix(at + 1);
    text = text.substr(0, text.find(' '));
    ++log.refused_[std::string(text.substr(0, text.rfind('/')))];
  }

  mutable std::mutex mutex_;
  std::string last_;
  std::map<std::string, std::uint64_t> refused_;  // by the topic's name on the wire
};

Participant::Participant(const Network& network) : log_(std::make_unique<Log>()) {
  const auto must = [&](std::int32_t made, const char* doing) {
    if (made >= 0) return made;
    const std::string words = log_->last_words();
    if (domain_ > 0) dds_delete(domain_);
    throw SetupError({"ROS 2",
                      std::string(doing) + " domain " + std::to_string(network.domain) + ": " +
                          (words.empty() ? dds_strretcode(made) : words),
                      "look at ROS_DOMAIN_ID, CYCLONEDDS_URI, and whether there is a network"});
  };
  domain_ = must(dds_create_domain(network.domain, network.configuration.c_str()), "opening");
  handle_ = must(dds_create_participant(network.domain, nullptr, nullptr), "joining");
}

Participant::~Participant() { dds_delete(domain_); }

std::optional<Offer> Participant::offer(const std::string& topic) const {
  constexpr std::uint32_t most = 1U << 20U;  // publishers in the whole network
  constexpr std::uint32_t at_once = 1024;
  const std::string wanted = wire_name(topic);
  std::optional<Offer> newest;
  dds_time_t newest_time = 0;
  // A new reader has all that are there. Only what is taken from it is not read again.
  const Entity publications(
      dds_create_reader(handle_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr), topic);
  std::vector<void*> samples(at_once);
  std::vector<dds_sample_info_t> infos(at_once);
  for (std::uint32_t seen = 0; seen < most; seen += at_once) {
    const std::int32_t count =
        dds_take_mask(publications.handle(), samples.data(), infos.data(), at_once, at_once,
                      DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE);
    for (std::int32_t i = 0; i < count; ++i) {
      const auto place = static_cast<std::size_t>(i);
      const auto* const endpoint = static_cast<const dds_builtintopic_endpoint_t*>(samples[place]);
      if (!infos[place].valid_data || endpoint->topic_name != wanted) continue;
      if (newest && infos[place].source_timestamp < newest_time) continue;
      newest_time = infos[place].source_timestamp;
      dds_reliability_kind_t kind = DDS_RELIABILITY_BEST_EFFORT;
      dds_duration_t blocking = 0;
      dds_qget_reliability(endpoint->qos, &kind, &blocking);
      newest = Offer{ros_type(endpoint->type_name), kind == DDS_RELIABILITY_RELIABLE};
    }
    if (count > 0) dds_return_loan(publications.handle(), samples.data(), count);
    if (count < static_cast<std::int32_t>(at_once)) break;
  }
  return newest;
}

std::uint64_t Participant::refused(const std::string& topic) const {
  return log_->refused(wire_name(topic));
}

}  // namespace seqloop::dds
