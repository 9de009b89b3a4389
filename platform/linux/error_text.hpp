#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <string_view>

namespace seqloop::live {

/// What an errno means, in words. Allocates: never.
[[nodiscard]] inline std::string_view error_text(int error) noexcept {
  const char* const text = strerrordesc_np(error);
  return text == nullptr ? std::string_view("unknown error") : std::string_view(text);
}

/// A number in words that can be put into a message. Allocates: never.
class Digits {
 public:
  explicit Digits(std::uint64_t number) noexcept
      : end_(std::to_chars(digits_.data(), digits_.data() + digits_.size(), number).ptr) {}
  Digits(const Digits&) = delete;
  Digits& operator=(const Digits&) = delete;
  Digits(Digits&&) = delete;
  Digits& operator=(Digits&&) = delete;
  ~Digits() = default;

  [[nodiscard]] std::string_view view() const noexcept {
    return {digits_.data(), static_cast<std::size_t>(end_ - digits_.data())};
  }

 private:
  std::array<char, 20> digits_{};
  char* end_;
};

}  // namespace seqloop::live
