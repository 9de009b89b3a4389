#include "seqloop/config_file.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "files/text_file.hpp"
#include "seqloop/verb.hpp"

namespace seqloop::program {
namespace {

std::string where(const std::string& file, const toml::node& node) {
  return file + ":" + std::to_string(node.source().begin.line);
}

/// A number as the command line would have it.
std::optional<std::string> number_text(const toml::node& node) {
  if (const auto* whole = node.as_integer()) return std::to_string(whole->get());
  if (const auto* decimal = node.as_floating_point()) return fmt::format("{}", decimal->get());
  return std::nullopt;
}

std::optional<std::string> array_text(const toml::node& node) {
  const toml::array* array = node.as_array();
  if (array == nullptr) return std::nullopt;
  std::string text;
  for (const toml::node& element : *array) {
    const auto number = number_text(element);
    if (!number) return std::nullopt;
    if (!text.empty()) text += ',';
    text += *number;
  }
  return text;
}

/// A value as the command line would have it; nothing when its type does not fit.
std::optional<std::string> value_text(const toml::node& node, ValueKind kind) {
  switch (kind) {
    case ValueKind::flag:
      if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
      return std::nullopt;
    case ValueKind::on_off:
      if (const auto* flag = node.as_boolean()) return flag->get() ? "on" : "off";
      break;
    case ValueKind::count:
      return node.is_integer() ? number_text(node) : std::nullopt;
    case ValueKind::number:
      return number_text(node);
    case ValueKind::triple:
      if (node.is_array()) return array_text(node);
      break;
    case ValueKind::text:
    case ValueKind::size:
      break;
  }
  if (const auto* text = node.as_string()) return text->get();
  return std::nullopt;
}

std::string wanted_type(ValueKind kind) {
  switch (kind) {
    case ValueKind::flag:
      return "true or false";
    case ValueKind::count:
      return "a whole number";
    case ValueKind::number:
      return "a number";
    case ValueKind::text:
      return "a string";
    case ValueKind::on_off:
      return "\"on\" or \"off\"";
    case ValueKind::size:
      return "a string like \"224x224\"";
    case ValueKind::triple:
      return "an array of three numbers";
  }
  return "something else";
}

class Reader {
 public:
  Reader(const std::string& file, const OptionTable& table, const std::set<std::string>& given,
         const std::vector<std::string>& known)
      : file_(file), table_(table), given_(given), known_(known) {}

  void read(const toml::table& values, const std::string& prefix) {
    for (const auto& [key, node] : values) {
      const std::string name = prefix + std::string(key.str());
      if (const toml::table* inner = node.as_table()) {
        read(*inner, name + "-");
      } else {
        take(name, node);
      }
    }
  }

  Faults faults;

 private:
  void take(const std::string& name, const toml::node& node) {
    const Option* option = table_.find(name);
    if (option == nullptr) {
      if (std::ranges::find(known_, name) == known_.end()) unknown(name, node);
      return;
    }
    const auto text = value_text(node, option->kind);
    if (!text) {
      std::ostringstream kind;
      kind << node.type();
      faults.push_back({where(file_, node), "'" + name + "' must be " + wanted_type(option->kind) +
                                                ", not " + kind.str()});
      return;
    }
    if (given_.contains(name)) return;
    for (const Fault& fault : table_.set(*option, *text)) {
      faults.push_back({where(file_, node), "'" + name + "': " + fault.why});
    }
  }

  void unknown(const std::string& name, const toml::node& node) {
    const std::string meant = nearest(name, known_);
    faults.push_back({where(file_, node), "'" + name + "' is no known key",
                      meant.empty() ? "" : "did you mean '" + meant + "'?"});
  }

  const std::string& file_;
  const OptionTable& table_;
  const std::set<std::string>& given_;
  const std::vector<std::string>& known_;
};

}  // namespace

Faults apply_config_text(std::string_view text, const std::string& name, const OptionTable& table,
                         const std::set<std::string>& given,
                         const std::vector<std::string>& known) {
  // The parser recurses once a level, and so do we; no setting lies deeper than one table.
  constexpr std::ptrdiff_t most_dots = 200;
  for (std::size_t line = 1, at = 0; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view key = text.substr(at, std::min(text.find_first_of("=#", at), end) - at);
    if (std::ranges::count(key, '.') > most_dots) {
      return {{name + ":" + std::to_string(line), "nested too deeply"}};
    }
    at = end + 1;
  }
  try {
    Reader reader(name, table, given, known);
    reader.read(toml::parse(text), "");
    return reader.faults;
  } catch (const toml::parse_error& error) {
    return {{name + ":" + std::to_string(error.source().begin.line),
             "not TOML: " + std::string(error.description())}};
  }
}

Faults apply_config_file(const std::filesystem::path& file, const OptionTable& table,
                         const std::set<std::string>& given,
                         const std::vector<std::string>& known) {
  Faults faults;
  collect(faults, [&] {
    faults = apply_config_text(files::read_text(file), file.string(), table, given, known);
  });
  return faults;
}

}  // namespace seqloop::program
