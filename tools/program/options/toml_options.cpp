// SPDX-License-Identifier: MIT
#include "program/options/toml_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <utility>

namespace seqloop::program {
namespace {

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

Fault wrong_type(const std::string& file, const toml::node& node, const std::string& name,
                 const std::string& wanted) {
  std::ostringstream kind;
  kind << node.type();
  return {where(file, node), fmt::format("'{}' must be {}, not {}", name, wanted, kind.str())};
}

bool earlier(const toml::node* a, const toml::node* b) {
  const auto begin = [](const toml::node* node) {
    return std::pair(node->source().begin.line, node->source().begin.column);
  };
  return begin(a) < begin(b);
}

class Reader {
 public:
  Reader(const std::string& file, const OptionTable& options, const OtherKeys& others,
         Faults& faults)
      : file_(file), options_(options), others_(others), faults_(faults) {}

  /// @param prefix of the options' names; @param tables the same as the file spells it
  void read(const toml::table& table, const std::string& prefix, const std::string& tables) {
    std::vector<std::pair<const toml::node*, std::string>> in_order;
    for (const auto& [key, node] : table) in_order.emplace_back(&node, key);
    std::ranges::sort(in_order,
                      [](const auto& a, const auto& b) { return earlier(a.first, b.first); });
    for (const auto& [node, key] : in_order) {
      const std::string name = prefix + key;
      const toml::table* inner = node->as_table();
      const bool ignorable = inner == nullptr || others_.tables;
      if (ignorable && std::ranges::find(others_.ignored, name) != others_.ignored.end()) continue;
      if (inner != nullptr) {
        read(*inner, name + "-", tables + key + ".");
      } else {
        take(name, tables + key, *node);
      }
    }
  }

  std::vector<WrittenOption> written;

 private:
  void take(const std::string& name, const std::string& key, const toml::node& node) {
    const Option* option = options_.find(name);
    if (option == nullptr) {
      std::vector<std::string> known = others_.ignored;
      for (const Option& each : options_.options()) known.push_back(each.name);
      const std::string meant = nearest(name, known);
      faults_.push_back({where(file_, node), "'" + name + "' is no known key",
                         meant.empty() ? "" : "did you mean '" + meant + "'?"});
      return;
    }
    WrittenOption found{option, key, where(file_, node), {}};
    const auto before = std::ranges::find(written, option, &WrittenOption::option);
    if (before != written.end()) {
      faults_.push_back({found.where,
                         fmt::format("'{}' sets '{}', which '{}' has set already ({})", key, name,
                                     before->key, before->where),
                         "leave one of them out"});
      return;
    }
    const toml::array* list = node.as_array();
    if (others_.lists && list != nullptr && option->kind != ValueKind::triple) {
      for (const toml::node& element : *list) add(found, name, element);
    } else {
      add(found, name, node);
    }
    for (std::size_t i = 1; i < found.values.size(); ++i) {
      if (std::find(found.values.begin(), found.values.begin() + static_cast<std::ptrdiff_t>(i),
                    found.values[i]) != found.values.begin() + static_cast<std::ptrdiff_t>(i)) {
        faults_.push_back({found.where, "'" + name + "' has " + found.values[i] + " twice"});
      }
    }
    if (list != nullptr && list->empty())
      faults_.push_back({found.where, "'" + name + "' is empty"});
    if (!found.values.empty()) written.push_back(std::move(found));
  }

  void add(WrittenOption& found, const std::string& name, const toml::node& node) {
    if (auto text = value_text(node, found.option->kind)) {
      found.values.push_back(std::move(*text));
    } else {
      faults_.push_back(wrong_type(file_, node, name, wanted_type(found.option->kind)));
    }
  }

  const std::string& file_;
  const OptionTable& options_;
  const OtherKeys& others_;
  Faults& faults_;
};

}  // namespace

std::string where(const std::string& file, const toml::node& node) {
  return file + ":" + std::to_string(node.source().begin.line);
}

std::vector<std::string> read_names(const toml::node& node, const std::string& file,
                                    const std::string& key, Faults& faults) {
  if (const auto* text = node.as_string()) return {text->get()};
  std::vector<std::string> names;
  if (const toml::array* list = node.as_array()) {
    for (const toml::node& element : *list) {
      if (const auto* text = element.as_string()) names.push_back(text->get());
    }
    if (names.size() == list->size() && !names.empty()) return names;
  }
  faults.push_back(wrong_type(file, node, key, "a string or a list of strings"));
  return {};
}

std::vector<WrittenOption> read_options(const toml::table& table, const std::string& file,
                                        const OptionTable& options, const OtherKeys& others,
                                        Faults& faults) {
  Reader reader(file, options, others, faults);
  reader.read(table, "", "");
  return std::move(reader.written);
}

Faults set_written(const WrittenOption& written, const std::string& value) {
  Faults faults;
  for (const Fault& fault : OptionTable::set(*written.option, value)) {
    faults.push_back({written.where, "'" + written.option->name + "': " + fault.why, fault.remedy});
  }
  return faults;
}

toml::table parse_toml(std::string_view text, const std::string& file) {
  constexpr std::ptrdiff_t most_dots = 200;
  for (std::size_t line = 1, at = 0; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view key = text.substr(at, std::min(text.find_first_of("=#", at), end) - at);
    if (std::ranges::count(key, '.') > most_dots) {
      throw SetupError({file + ":" + std::to_string(line), "nested too deeply"});
    }
    at = end + 1;
  }
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw SetupError({file + ":" + std::to_string(error.source().begin.line),
                      "not TOML: " + std::string(error.description())});
  }
}

}  // namespace seqloop::program
