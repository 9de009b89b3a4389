// SPDX-License-Identifier: MIT
#include "seqloop/bags/loop_bag.hpp"

#include <utility>

#include "bags/mcap_writer.hpp"

namespace seqloop::bags {

class LoopBag::Impl {
 public:
  explicit Impl(Write write)
      : writer_(std::move(write), {"/seqloop/loop_closures", "seqloop_msgs/msg/LoopClosure",
                                   ros::loop_closure_definition()}) {}

  McapWriter writer_;
};

LoopBag::LoopBag(Write write) : impl_(std::make_unique<Impl>(std::move(write))) {}

LoopBag::~LoopBag() = default;

void LoopBag::add(const ros::LoopClosure& closure, std::int64_t known_ns) {
  impl_->writer_.add(known_ns, ros::message_of(closure));
}

void LoopBag::finish() { impl_->writer_.finish(); }

}  // namespace seqloop::bags
