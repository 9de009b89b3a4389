// SPDX-License-Identifier: MIT
#include "seqloop/dds/fleet.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "dds/entity.hpp"
#include "dds/idl/fleet.h"

namespace seqloop::dds {
namespace {

constexpr const char* topic_name = "seqloop_fleet/places";

// What any number of robots may begin; more are not heard.
constexpr std::int32_t most_sessions = 4096;

Qos places_qos(std::size_t kept) {
  constexpr dds_duration_t patience = DDS_MSECS(100);
  // Of each place, what it is a visit of may be told, too.
  const auto depth = static_cast<std::int32_t>(
      std::min<std::size_t>(2 * kept, std::numeric_limits<std::int32_t>::max()));
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, patience);
  dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  dds_qset_resource_limits(qos.get(), DDS_LENGTH_UNLIMITED, most_sessions, DDS_LENGTH_UNLIMITED);
  dds_qset_writer_data_lifecycle(qos.get(), false);
  dds_qset_ignorelocal(qos.get(), DDS_IGNORELOCAL_PARTICIPANT);
  return qos;
}

Qos partition_qos(const std::string& name) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  const char* partition = name.c_str();
  dds_qset_partition(qos.get(), 1, &partition);
  return qos;
}

/// As text() in entity.hpp.
dds_sequence_double numbers(std::span<const double> values) {
  dds_sequence_double sequence{};
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(values.size());
  sequence._buffer = const_cast<double*>(values.data());
  return sequence;
}

std::span<const double> numbers(const dds_sequence_double& sequence) {
  return {sequence._buffer, std::size_t{sequence._length}};
}

std::string words(const char* text) { return text == nullptr ? std::string() : text; }

}  // namespace

class Fleet::Impl {
 public:
  Impl(const Participant& participant, const std::string& name, std::size_t kept)
      : topic_(dds_create_topic(participant.handle(), &seqloop_fleet_Place_desc, topic_name,
                                nullptr, nullptr),
               topic_name),
        publisher_(dds_create_publisher(participant.handle(), partition_qos(name).get(), nullptr),
                   name),
        subscriber_(dds_create_subscriber(participant.handle(), partition_qos(name).get(), nullptr),
                    name),
        writer_(dds_create_writer(publisher_.handle(), topic_.handle(), places_qos(kept).get(),
                                  nullptr),
                topic_name),
        reader_(dds_create_reader(subscriber_.handle(), topic_.handle(), places_qos(kept).get(),
                                  nullptr),
                topic_name),
        waits_(dds_create_waitset(participant.handle()), topic_name) {
    dds_set_status_mask(reader_.handle(), DDS_DATA_AVAILABLE_STATUS);
    dds_waitset_attach(waits_.handle(), reader_.handle(), 0);
  }

  bool publish(const FleetPlace& place, const FleetSession* session) {
    seqloop_fleet_About about{};
    seqloop_fleet_Place sample{};
    sample.session = place.session;
    sample.frame = place.frame;
    sample.time_ns = place.time_ns;
    if (session != nullptr) {
      about.robot = text(session->robot);
      about.session = text(session->name);
      about.form = text(session->form);
      about.describer = text(session->describer);
      about.descriptor_size = session->descriptor_size;
      about.place_bytes = session->place_bytes;
      sample.about._length = sample.about._maximum = 1;
      sample.about._buffer = &about;
    }
    seqloop_fleet_Visit visit{};
    if (place.visit) {
      visit = {place.visit->session, place.visit->frame};
      sample.visit._length = sample.visit._maximum = 1;
      sample.visit._buffer = &visit;
    }
    seqloop_fleet_Statistics statistics{};
    if (place.statistics) {
      statistics = {place.statistics->frames, numbers(place.statistics->mean),
                    numbers(place.statistics->variance)};
      sample.statistics._length = sample.statistics._maximum = 1;
      sample.statistics._buffer = &statistics;
    }
    const auto size = static_cast<std::uint32_t>(place.bytes.size());
    sample.bytes._length = sample.bytes._maximum = size;
    sample.bytes._buffer = const_cast<std::uint8_t*>(
        static_cast<const std::uint8_t*>(static_cast<const void*>(place.bytes.data())));
    return dds_write(writer_.handle(), &sample) == DDS_RETCODE_OK;
  }

  void wait(Nanoseconds at_most) noexcept {
    dds_waitset_wait(waits_.handle(), nullptr, 0, at_most.count());
  }

  bool take(const std::function<void(const FleetPlace&, const FleetSession*)>& hear,
            const std::function<void(std::int64_t)>& gone) {
    void* sample = nullptr;
    dds_sample_info_t info{};
    const std::int32_t count = dds_take(reader_.handle(), &sample, &info, 1, 1);
    if (count <= 0) return false;
    const auto give_back = [&](void* const* loan) {
      dds_return_loan(reader_.handle(), const_cast<void**>(loan), count);
    };
    const std::unique_ptr<void*, decltype(give_back)> loan(&sample, give_back);
    const auto& place = *static_cast<const seqloop_fleet_Place*>(sample);
    if (!info.valid_data) {
      const bool nobody = info.instance_state == DDS_NOT_ALIVE_NO_WRITERS_INSTANCE_STATE;
      if (gone && nobody) gone(place.session);
      return true;
    }
    FleetPlace heard{
        place.session,
        place.frame,
        place.time_ns,
        std::as_bytes(std::span(place.bytes._buffer, std::size_t{place.bytes._length})),
        {},
        {}};
    if (place.visit._length == 1) {
      heard.visit = {place.visit._buffer[0].session, place.visit._buffer[0].frame};
    }
    if (place.statistics._length == 1) {
      const seqloop_fleet_Statistics& its = place.statistics._buffer[0];
      heard.statistics = {its.frames, numbers(its.mean), numbers(its.variance)};
    }
    if (place.about._length == 0) {
      hear(heard, nullptr);
      return true;
    }
    const seqloop_fleet_About& about = place.about._buffer[0];
    const FleetSession session{words(about.robot),     words(about.session),  words(about.form),
                               words(about.describer), about.descriptor_size, about.place_bytes};
    hear(heard, &session);
    return true;
  }

  [[nodiscard]] std::uint32_t others() const noexcept {
    dds_subscription_matched_status_t status{};
    dds_get_subscription_matched_status(reader_.handle(), &status);
    return status.current_count;
  }

  void flush(Nanoseconds at_most) noexcept { dds_wait_for_acks(writer_.handle(), at_most.count()); }

 private:
  Entity topic_;
  Entity publisher_;
  Entity subscriber_;
  Entity writer_;
  Entity reader_;
  Entity waits_;
};

Fleet::Fleet(const Participant& participant, const std::string& name, std::size_t kept)
    : impl_(std::make_unique<Impl>(participant, name, kept)) {}

Fleet::~Fleet() = default;

bool Fleet::publish(const FleetPlace& place, const FleetSession* session) {
  return impl_->publish(place, session);
}

void Fleet::wait(Nanoseconds at_most) noexcept { impl_->wait(at_most); }

bool Fleet::take(const std::function<void(const FleetPlace&, const FleetSession*)>& hear,
                 const std::function<void(std::int64_t)>& gone) {
  return impl_->take(hear, gone);
}

std::uint32_t Fleet::others() const noexcept { return impl_->others(); }

void Fleet::flush(Nanoseconds at_most) noexcept { impl_->flush(at_most); }

}  // namespace seqloop::dds
