// SPDX-License-Identifier: MIT
#include "seqloop/bags/bag_source.hpp"

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include "ros/pictures.hpp"
#include "seqloop/bags/bag.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/fault.hpp"
#include "seqloop/fixed_text.hpp"

namespace seqloop::bags {
namespace {

/// "/a (sensor_msgs/msg/Image, 12 messages), ..."
std::string list(const std::vector<Topic>& topics) {
  constexpr std::size_t most = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(topics.size(), most); ++i)
    text += (i == 0 ? "" : ", ") + topics[i].name + " (" + topics[i].type + ", " +
            counted(topics[i].messages, "message") + ")";
  return text + (topics.size() > most ? ", ..." : "");
}

const Topic& choose_topic(const BagFacts& facts, const std::string& path, const std::string& name) {
  std::vector<Topic> pictures;
  std::ranges::copy_if(facts.topics, std::back_inserter(pictures), [](const Topic& topic) {
    return ros::picture_type(topic.type) != ros::PictureType::none;
  });
  if (name.empty() && pictures.size() > 1)
    throw SetupError(
        Fault{path, "has several topics with pictures: " + list(pictures), "choose one: --topic"});
  if (pictures.empty())
    throw SetupError(Fault{path,
                           facts.topics.empty()
                               ? "holds no topic"
                               : "has no topic with pictures: " + list(facts.topics),
                           "sensor_msgs/msg/Image and CompressedImage are read"});
  const std::string& wanted = name.empty() ? pictures.front().name : name;
  const auto found = std::ranges::find(facts.topics, wanted, &Topic::name);
  if (found == facts.topics.end())
    throw SetupError(Fault{path, "has no topic " + name + "; with pictures: " + list(pictures),
                           "choose one: --topic"});
  if (ros::picture_type(found->type) == ros::PictureType::none)
    throw SetupError(
        Fault{path, name + " is " + found->type + ", no pictures; with pictures: " + list(pictures),
              "choose one: --topic"});
  if (found->encoding != "cdr")
    throw SetupError(Fault{path, wanted + " is encoded as '" + found->encoding + "', not as cdr",
                           "convert the bag to ROS 2's own encoding"});
  if (found->messages == 0) throw SetupError(Fault{path, wanted + " has no messages"});
  return *found;
}

}  // namespace

class BagSource::Impl {
 public:
  Impl(const std::filesystem::path& path, const std::string& topic,
       std::unique_ptr<PictureDecoder> decoder)
      : bag_(open_bag(path)),
        topic_(choose_topic(bag_->facts(), path.string(), topic)),
        type_(ros::picture_type(topic_.type)),
        decoder_(std::move(decoder)) {
    look_at_first();
    bag_->choose(topic_.name);
  }

  [[nodiscard]] Grab grab(Frame& frame) noexcept {
    frame = {};
    frame.index = next_;
    frame.time_s = time_s_;
    try {
      Message message;
      const Read read = bag_->next(message);
      if (read == Read::end) return Grab::end;
      ++next_;
      if (read == Read::damaged) return unreadable(frame, message.fault);
      return take(message, frame);
    } catch (const std::exception&) {
      next_ = frame.index + 1;
      return unreadable(frame, "there is not enough memory");
    }
  }

  [[nodiscard]] std::uint64_t frame_count() const noexcept { return topic_.messages; }

  [[nodiscard]] std::int64_t start_ns() const noexcept { return start_ns_; }

  [[nodiscard]] std::vector<std::string> notes() const {
    std::vector<std::string> lines = bag_->notes();
    if (!stamped_)
      lines.emplace_back("the pictures have no stamps: the times are those of the recording");
    if (late_ > 0)
      lines.push_back(counted(late_, "picture") +
                      " without a later stamp than the one before: between them the times are "
                      "those of the recording");
    return lines;
  }

 private:
  /// Finds when the drive begins, and by which clock.
  void look_at_first() {
    bag_->choose(topic_.name);
    Message message;
    Read read = bag_->next(message);
    // The first that can be read; where none can, the first of all.
    std::optional<std::int64_t> recorded;
    for (; read != Read::end; read = bag_->next(message)) {
      if (read == Read::damaged) continue;
      if (!recorded) recorded = message.time_ns;
      const ros::PictureMessage first = ros::read_picture(type_, message.bytes, fault_);
      if (!fault_.empty()) continue;
      stamped_ = first.stamp_ns != 0;
      start_ns_ = stamped_ ? first.stamp_ns : *recorded;
      return;
    }
    start_ns_ = recorded.value_or(0);
  }

  [[nodiscard]] Grab take(const Message& message, Frame& frame) {
    const ros::PictureMessage read = ros::read_picture(type_, message.bytes, fault_);
    const std::int64_t now = stamped_ ? read.stamp_ns : message.time_ns;
    time_s_ = time_of(now, message.time_ns, !stamped_ || (fault_.empty() && now != 0));
    frame.time_s = time_s_;
    if (!fault_.empty()) return unreadable(frame, fault_.view());
    const std::string_view fault = decoder_->decode(read.picture, frame.image);
    return fault.empty() ? Grab::frame : unreadable(frame, fault);
  }

  /// Of a picture by its stamp. Where the stamps' clock stands still or was set, time goes on as it
  /// does in the recording, and from there by the clock, until that is no longer behind.
  /// @param known whether it has a stamp; otherwise the time is the recording's
  [[nodiscard]] double time_of(std::int64_t stamp_ns, std::int64_t recorded_ns, bool known) {
    constexpr double at_once = 1.0;  // more than the recording has: somebody has set the clock
    const double since_last = began_ ? std::max(0.0, seconds(last_recorded_ns_, recorded_ns)) : 0.0;
    last_recorded_ns_ = recorded_ns;
    if (!known) return time_s_ + since_last;
    const double by_stamp = seconds(start_ns_, stamp_ns);
    const double step = began_ ? seconds(last_ns_, stamp_ns) : 0.0;
    last_ns_ = stamp_ns;
    if (by_stamp > time_s_) {
      behind_s_ = 0.0;
    } else if (began_ && (step <= 0.0 || step > since_last + at_once)) {
      if (stamped_) ++late_;
      behind_s_ = time_s_ + since_last - by_stamp;
    }
    began_ = true;
    return std::max(time_s_, by_stamp + behind_s_);
  }

  /// Seconds and the rest by themselves, so that no stamp is too large; together they are exact.
  static double seconds(std::int64_t from_ns, std::int64_t to_ns) {
    const std::int64_t whole = to_ns / second - from_ns / second;
    const std::int64_t rest = to_ns % second - from_ns % second;
    return (static_cast<double>(whole) * 1e9 + static_cast<double>(rest)) / 1e9;
  }

  static Grab unreadable(Frame& frame, std::string_view fault) noexcept {
    frame.image = {};
    frame.fault = fault;
    return Grab::unreadable;
  }

  static constexpr std::int64_t second = 1'000'000'000;

  std::unique_ptr<Bag> bag_;
  Topic topic_;
  ros::PictureType type_;
  std::unique_ptr<PictureDecoder> decoder_;
  FixedText fault_;
  bool stamped_ = false;
  std::int64_t start_ns_ = 0;
  bool began_ = false;                 // a picture had a time of its own
  std::int64_t last_ns_ = 0;           // of the last that had, by its stamp
  std::int64_t last_recorded_ns_ = 0;  // of the picture before, by the recording
  double behind_s_ = 0.0;              // how far the stamps' clock was set back
  double time_s_ = 0.0;
  std::uint64_t next_ = 0;
  std::uint64_t late_ = 0;
};

BagSource::BagSource(const std::filesystem::path& path, const std::string& topic,
                     std::unique_ptr<PictureDecoder> decoder)
    : impl_(std::make_unique<Impl>(path, topic, std::move(decoder))) {}

BagSource::~BagSource() = default;

Grab BagSource::grab(Frame& frame) noexcept { return impl_->grab(frame); }

std::optional<std::uint64_t> BagSource::frame_count() const noexcept {
  return impl_->frame_count();
}

std::vector<std::string> BagSource::notes() const { return impl_->notes(); }

std::int64_t BagSource::start_ns() const noexcept { return impl_->start_ns(); }

}  // namespace seqloop::bags
