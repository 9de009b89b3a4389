// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "program/process/outputs.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::program {

/// How a value is written, on the command line and in a TOML file.
enum class ValueKind {
  flag,    ///< true or false; on the command line no value is true
  count,   ///< whole number, 0 or more
  number,  ///< decimal number
  text,
  on_off,  ///< on or off; in TOML true and false too
  size,    ///< WxH in pixels
  triple   ///< three numbers B,G,R; in TOML an array too
};

/// When a flag is shown.
enum class Shown {
  in_help,     ///< by --help
  in_help_all  ///< by --help-all only: few need it
};

/// One setting: a long flag, and a TOML key of the same name.
struct Option {
  std::string name;  ///< without dashes in front
  ValueKind kind;
  std::string help;
  /// Takes the value as written on the command line. Throws std::invalid_argument: why not.
  std::function<void(std::string_view)> set;
  /// What is read and written by it, once everything is set. May throw SetupError.
  std::function<std::vector<FileUse>()> files = {};
  std::string section = "Options";  ///< heading of the help
  Shown shown = Shown::in_help;
  bool may_be_bare = false;  ///< on the command line without a value, which is then empty
};

/// The settings of one subcommand. Every value is taken as text and converted here, so that all
/// faults of a command line and a file come out together.
class OptionTable {
 public:
  void flag(std::string name, bool& target, std::string help);
  void count(std::string name, std::size_t& target, std::string help);
  void number(std::string name, double& target, std::string help);
  void number(std::string name, float& target, std::string help);
  void text(std::string name, std::string& target, std::string help);
  /// A path says what becomes of what it names.
  void path(std::string name, Access access, std::filesystem::path& target, std::string help);
  /// A folder to fill. @param files that are known beforehand to come there
  void folder(const std::string& name, std::filesystem::path& target,
              std::vector<std::string> files, std::string help);
  void on_off(std::string name, bool& target, std::string help);
  void add(Option option);

  /// Says what all settings that are added from here on belong to.
  void section(std::string heading, Shown shown = Shown::in_help);

  [[nodiscard]] const std::vector<Option>& options() const noexcept { return options_; }
  [[nodiscard]] const Option* find(std::string_view name) const noexcept;

  /// All that is read and written by what the options are set to, as far as that can be told.
  [[nodiscard]] std::vector<FileUse> files() const;

  /// Takes one value. @return why not, with the name; nothing when it fits
  [[nodiscard]] static Faults set(const Option& option, std::string_view value);

 private:
  std::vector<Option> options_;
  std::string section_ = "Options";
  Shown shown_ = Shown::in_help;
};

/// @return the name that is written most like this one, when one is near enough to be meant
[[nodiscard]] std::string nearest(std::string_view name, const std::vector<std::string>& known);

/// Most often a variable of a script is not set: to go on as if nothing was asked for would lose
/// what was. @param name of the option
[[nodiscard]] Fault empty_value(std::string name);

/// Numbers as C writes them, in any locale. Throw std::invalid_argument: why not.
[[nodiscard]] std::size_t parse_count(std::string_view text);
[[nodiscard]] double parse_number(std::string_view text);
[[nodiscard]] bool parse_on_off(std::string_view text);
[[nodiscard]] std::vector<double> parse_numbers(std::string_view text, char separator);
/// A whole number of pixels, up to 16384.
[[nodiscard]] int parse_pixels(std::string_view text, std::size_t least);
/// WxH, each 1 or more. @return width, height
[[nodiscard]] std::pair<int, int> parse_size(std::string_view text);

}  // namespace seqloop::program
