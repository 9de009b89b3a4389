// SPDX-License-Identifier: MIT
// A publisher and a subscriber of ROS 2 that share no code with Cyclone DDS or with us: eProsima
// Fast DDS, which is given messages as bytes.
//
// Usage: fast_end publish TOPIC TYPE reliable|best_effort [PARTITION]    messages from standard
//        input
//        fast_end listen  TOPIC TYPE reliable|best_effort [PARTITION]    messages to standard
//        output
// TOPIC and TYPE as DDS names them. With a partition, the first eight bytes of a message are its
// key, and who comes late hears what was published before. A message is 4 bytes that say how long
// it is, 4 that say when it is due, in microseconds after the first one, and its CDR. The domain is
// ROS_DOMAIN_ID. `publish` waits until it is heard, and in the end until all has arrived; it says
// "heard" on stderr. `listen` says "listening", and "heard" when it has found who publishes; it
// ends when standard input does, and it has taken all that came.
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

using Bytes = std::vector<std::uint8_t>;

/// Whatever the bytes are.
class Raw : public fast::TopicDataType {
 public:
  Raw(const std::string& name, bool has_key) {
    setName(name.c_str());
    m_typeSize = 16U << 20U;
    m_isGetKeyDefined = has_key;
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    if (payload->max_size < bytes.size()) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void* data, rtps::InstanceHandle_t* handle, bool) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    constexpr std::size_t header = 4;
    if (!m_isGetKeyDefined || bytes.size() < header + key_size) return false;
    for (std::size_t i = 0; i < 16; ++i) handle->value[i] = i < key_size ? bytes[header + i] : 0;
    return true;
  }

 private:
  static constexpr std::size_t key_size = 8;
};

bool read(void* to, std::size_t size) {
  return static_cast<bool>(
      std::cin.read(static_cast<char*>(to), static_cast<std::streamsize>(size)));
}

int publish(fast::DomainParticipant& participant, fast::Topic* topic, bool reliable,
            const char* partition) {
  fast::DataWriterQos qos;
  qos.reliability().kind =
      reliable ? fast::RELIABLE_RELIABILITY_QOS : fast::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = fast::VOLATILE_DURABILITY_QOS;
  // So that none is overwritten before it has arrived, however busy the machine is.
  qos.history().kind = fast::KEEP_ALL_HISTORY_QOS;
  qos.resource_limits().max_samples = 2000;
  qos.resource_limits().max_samples_per_instance = 2000;
  qos.reliability().max_blocking_time = {60, 0};
  // What was lost is asked for at once, not after the usual 3 s.
  qos.reliable_writer_qos().times.heartbeatPeriod = {0, 100'000'000};
  // Large messages go out in pieces, whose sizes differ.
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.publish_mode().kind = fast::SYNCHRONOUS_PUBLISH_MODE;
  fast::PublisherQos where = fast::PUBLISHER_QOS_DEFAULT;
  if (partition != nullptr) {
    where.partition().push_back(partition);
    qos.durability().kind = fast::TRANSIENT_LOCAL_DURABILITY_QOS;
    qos.resource_limits().max_samples = 50'000;
    qos.resource_limits().max_instances = 10;
    qos.resource_limits().max_samples_per_instance = 5000;
  }
  fast::DataWriter* const writer =
      participant.create_publisher(where)->create_datawriter(topic, qos);
  if (writer == nullptr) return 2;
  using Clock = std::chrono::steady_clock;
  fast::PublicationMatchedStatus matched;
  while (writer->get_publication_matched_status(matched) == ReturnCode_t::RETCODE_OK &&
         matched.current_count == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::cerr << "heard" << std::endl;
  const auto start = Clock::now();
  std::array<std::uint32_t, 2> head{};
  Bytes message;
  while (read(head.data(), sizeof(head))) {
    message.resize(head[0]);
    if (!read(message.data(), message.size())) return 2;
    std::this_thread::sleep_until(start + std::chrono::microseconds(head[1]));
    if (!writer->write(&message)) std::cerr << "not written" << std::endl;
  }
  writer->wait_for_acknowledgments({10, 0});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  return 0;
}

int listen(fast::DomainParticipant& participant, fast::Topic* topic, bool reliable,
           const char* partition) {
  fast::DataReaderQos qos;
  qos.reliability().kind =
      reliable ? fast::RELIABLE_RELIABILITY_QOS : fast::BEST_EFFORT_RELIABILITY_QOS;
  qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 100;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  fast::SubscriberQos where = fast::SUBSCRIBER_QOS_DEFAULT;
  if (partition != nullptr) {
    where.partition().push_back(partition);
    qos.durability().kind = fast::TRANSIENT_LOCAL_DURABILITY_QOS;
    qos.history().depth = 5000;
    qos.resource_limits().max_samples = 20'000;
    qos.resource_limits().max_instances = 4;
    qos.resource_limits().max_samples_per_instance = 5000;
  }
  fast::DataReader* const reader =
      participant.create_subscriber(where)->create_datareader(topic, qos);
  if (reader == nullptr) return 2;
  std::cerr << "listening" << std::endl;
  Bytes message;
  fast::SampleInfo info;
  bool heard = false;
  bool over = false;
  while (std::cout && !over) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    over = ::poll(&input, 1, 0) > 0;  // before the last look
    fast::SubscriptionMatchedStatus matched;
    if (!heard && reader->get_subscription_matched_status(matched) == ReturnCode_t::RETCODE_OK &&
        matched.current_count > 0) {
      heard = true;
      std::cerr << "heard" << std::endl;
    }
    reader->wait_for_unread_message({0, 100'000'000});
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      const std::array<std::uint32_t, 2> head{static_cast<std::uint32_t>(message.size()), 0};
      std::cout.write(static_cast<const char*>(static_cast<const void*>(head.data())),
                      sizeof(head));
      std::cout.write(static_cast<const char*>(static_cast<const void*>(message.data())),
                      static_cast<std::streamsize>(message.size()));
      std::cout.flush();
    }
  }
  return 0;
}

}  // namespace

int main(int count, char** words) {
  if (count != 5 && count != 6) return 2;
  const char* const partition = count == 6 ? words[5] : nullptr;
  const std::string verb = words[1];
  const bool reliable = std::string(words[4]) == "reliable";
  const char* const domain = std::getenv("ROS_DOMAIN_ID");
  fast::DomainParticipantQos qos;
  // Over the loopback interface, and not by shared memory: that is not DDS's wire.
  qos.transport().use_builtin_transports = false;
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  udp->sendBufferSize = udp->receiveBufferSize = 4U << 20U;
  qos.transport().user_transports.push_back(udp);
  auto* const participant = fast::DomainParticipantFactory::get_instance()->create_participant(
      domain == nullptr ? 0 : static_cast<std::uint32_t>(std::atoi(domain)), qos);
  if (participant == nullptr) return 2;
  const fast::TypeSupport type(new Raw(words[3], partition != nullptr));
  type.register_type(participant);
  fast::Topic* const topic = participant->create_topic(words[2], words[3], fast::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) return 2;
  const int code = verb == "publish" ? publish(*participant, topic, reliable, partition)
                                     : listen(*participant, topic, reliable, partition);
  // Its threads are ended by hand nowhere: the process is.
  std::cout.flush();
  participant->delete_contained_entities();
  fast::DomainParticipantFactory::get_instance()->delete_participant(participant);
  return code;
}
