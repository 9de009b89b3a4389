// SPDX-License-Identifier: MIT
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <memory>
#include <string>

#include "dds/topic_type.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::dds {

/// Something of DDS that is given back.
class Entity {
 public:
  Entity() noexcept = default;
  /// @param made what DDS returned. Throws SetupError where that is an error.
  Entity(dds_return_t made, const std::string& topic) : handle_(made) {
    if (made < 0) throw SetupError({topic, std::string("DDS says: ") + dds_strretcode(made)});
  }
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  Entity(Entity&&) = delete;
  Entity& operator=(Entity&&) = delete;
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }

  [[nodiscard]] dds_entity_t handle() const noexcept { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

/// As ROS 2 sets it: volatile, the newest `depth` messages, the definition's hash in USER_DATA.
inline Qos make_qos(const TopicType& type, bool reliable, std::int32_t depth) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  dds_qset_reliability(qos.get(), reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       0);
  dds_qset_writer_data_lifecycle(qos.get(), false);
  const std::string words = "typehash=" + std::string(type.hash) + ";";
  dds_qset_userdata(qos.get(), words.data(), words.size());
  return qos;
}

/// For members of a message that is only written, never changed: C has no way to say so.
inline char* text(const std::string& words) { return const_cast<char*>(words.c_str()); }

}  // namespace seqloop::dds
