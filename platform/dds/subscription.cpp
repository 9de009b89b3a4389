// SPDX-License-Identifier: MIT
#include "dds/subscription.hpp"

#include <dds/ddsi/ddsi_serdata.h>

#include <utility>

namespace seqloop::dds {

Message::Message(ddsi_serdata* data) noexcept : data_(data) {
  const std::size_t size = ddsi_serdata_size(data);
  ddsrt_iovec_t whole{};
  // DDS's own serialised data lie in one piece, and stay as long as they are referred to.
  ddsi_serdata_to_ser_unref(ddsi_serdata_to_ser_ref(data, 0, size, &whole), &whole);
  bytes_ = {static_cast<const std::uint8_t*>(whole.iov_base), size};
}

Message::Message(Message&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), bytes_(std::exchange(other.bytes_, {})) {}

Message& Message::operator=(Message&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

Message::~Message() {
  if (data_ != nullptr) ddsi_serdata_unref(data_);
}

Subscription::Subscription(const Participant& participant, const std::string& topic,
                           const TopicType& type, bool reliable, std::int32_t depth)
    : topic_(dds_create_topic(participant.handle(), type.descriptor, wire_name(topic).c_str(),
                              nullptr, nullptr),
             topic),
      reader_(dds_create_reader(participant.handle(), topic_.handle(),
                                make_qos(type, reliable, depth).get(), nullptr),
              topic),
      waits_(dds_create_waitset(participant.handle()), topic) {
  dds_set_status_mask(reader_.handle(), DDS_DATA_AVAILABLE_STATUS);
  dds_waitset_attach(waits_.handle(), reader_.handle(), 0);
}

void Subscription::wait(Nanoseconds at_most) noexcept {
  dds_waitset_wait(waits_.handle(), nullptr, 0, at_most.count());
}

Message Subscription::take() noexcept {
  while (true) {
    ddsi_serdata* data = nullptr;
    dds_sample_info_t info{};
    if (dds_takecdr(reader_.handle(), &data, 1, &info, DDS_ANY_STATE) <= 0) return {};
    if (info.valid_data) return Message(data);
    ddsi_serdata_unref(data);  // a publisher that has gone
  }
}

std::uint32_t Subscription::publishers() const noexcept {
  dds_subscription_matched_status_t status{};
  dds_get_subscription_matched_status(reader_.handle(), &status);
  return status.current_count;
}

}  // namespace seqloop::dds
