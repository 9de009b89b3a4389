// SPDX-License-Identifier: MIT
#pragma once

#include <exception>
#include <new>
#include <opencv2/core.hpp>
#include <span>
#include <string>

#include "opencv/detail/one_line.hpp"
#include "opencv/detail/picture_view.hpp"
#include "seqloop/describer.hpp"

namespace seqloop::opencv {

/// One call of a describer: nothing is thrown, and picture and descriptor are looked at first.
/// @param fault set to why it failed, else emptied
/// @param size  D
/// @param work  gives the Description; where that is `failed`, it has set the fault itself
template <class Work>
[[nodiscard]] Description guarded(std::string& fault, const Image& image,
                                  std::span<const float> descriptor, std::size_t size,
                                  Work work) noexcept {
  try {
    fault = fault_of(image);
    if (fault.empty() && descriptor.size() != size) fault = "the descriptor has another length";
    if (!fault.empty()) return Description::failed;
    const auto no_memory = [&image] {
      return "there is not enough memory to describe a picture of " + std::to_string(image.width) +
             "x" + std::to_string(image.height);
    };
    try {
      return work();
    } catch (const cv::Exception& error) {
      fault = error.code == cv::Error::StsNoMem ? no_memory() : "OpenCV: " + one_line(error.err);
    } catch (const std::bad_alloc&) {
      fault = no_memory();
    } catch (const std::exception& error) {
      fault = error.what();
    }
  } catch (...) {  // no memory left for the message
  }
  return Description::failed;
}

}  // namespace seqloop::opencv
