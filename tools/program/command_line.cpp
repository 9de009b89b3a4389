// SPDX-License-Identifier: MIT
#include "program/command_line.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "program/options/config_file.hpp"
#include "program/options/flag_names.hpp"
#include "program/process/build_info.hpp"
#include "program/process/say.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/opencv/silence.hpp"

namespace seqloop::program {
namespace {

enum ExitCode : int { done = 0, failed_while_running = 1, bad_usage = 2 };

/// What the command line says of one verb, as text.
struct Given {
  std::vector<std::pair<const Option*, std::vector<std::string>>> values;
  std::vector<std::string> config_files;
};

const char* value_name(ValueKind kind) {
  switch (kind) {
    case ValueKind::count:
      return "N";
    case ValueKind::number:
      return "X";
    case ValueKind::on_off:
      return "on|off";
    case ValueKind::size:
      return "WxH";
    case ValueKind::triple:
      return "B,G,R";
    case ValueKind::flag:
    case ValueKind::text:
      break;
  }
  return "TEXT";
}

constexpr std::size_t help_width = 100;  // columns of the help, and of its flags alone
constexpr std::size_t flags_width = 28;

/// The words of a flag's help in lines that fit beside the flags.
std::string in_lines(std::string_view words) {
  std::string lines;
  for (std::size_t used = 0; !words.empty();) {
    const std::size_t end = std::min(words.find(' '), words.size());
    const bool fits = used + 1 + end <= help_width - flags_width;
    if (!lines.empty()) lines += fits ? ' ' : '\n';
    used = fits && used > 0 ? used + 1 + end : end;
    lines += words.substr(0, end);
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return lines;
}

/// CLI11's layout with one empty line, not two, between headings.
class Layout : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    return CLI::detail::find_and_replace(Formatter::make_help(app, std::move(name), mode), "\n\n\n",
                                         "\n\n");
  }
};

/// What stands below the flags.
std::string footer(const Verb& verb, bool show_all) {
  const auto hidden =
      std::ranges::count(verb.options.options(), Shown::in_help_all, &Option::shown);
  std::string text = verb.tasks;
  if (hidden > 0 && !show_all)
    text += fmt::format("{}{}: seqloop {} --help-all", text.empty() ? "" : "\n\n",
                        counted(static_cast<std::uint64_t>(hidden), "more flag"), verb.name);
  return text;
}

/// A flag with a value; one that is given more than once is told later, with all other faults.
CLI::Option* add_value(CLI::App& app, const std::string& name, std::vector<std::string>& values,
                       const std::string& help, ValueKind kind, bool may_be_bare) {
  return app.add_option("--" + name, values, help)
      ->type_name(value_name(kind))
      ->expected(may_be_bare ? 0 : 1, 1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
}

/// @param show_all flags that few need are shown, too
void add_to(CLI::App& app, const Verb& verb, Given& given, bool show_all) {
  CLI::App* sub = app.add_subcommand(verb.name, verb.help);
  sub->allow_extras();
  given.values.reserve(verb.options.options().size());
  for (const Option& option : verb.options.options()) {
    auto& [known, values] = given.values.emplace_back();
    known = &option;
    CLI::Option* flag = option.kind == ValueKind::flag
                            ? sub->add_flag("--" + option.name, values, in_lines(option.help))
                                  ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
                            : add_value(*sub, option.name, values, in_lines(option.help),
                                        option.kind, option.may_be_bare);
    // No name: CLI11 does not show it.
    flag->group(option.shown == Shown::in_help || show_all ? option.section : "");
  }
  const std::string general = "General";
  add_value(*sub, "config", given.config_files, "settings from a TOML file; flags win over it",
            ValueKind::text, false)
      ->group(general);
  sub->set_help_flag("-h,--help", "print the flags that are used most")->group(general);
  sub->set_help_all_flag("--help-all", "print all flags")->group(general);
  sub->set_version_flag("--version", app.version(), "print the version")->group(general);
  sub->footer(footer(verb, show_all));
}

/// Everything that the command line and the configuration file get wrong, at once.
/// @param extras what is no flag of the verb, or no flag at all
/// @param behind what is no flag, even where it looks like one
Faults settle(const Verb& verb, const Given& given, const std::vector<std::string>& extras,
              const std::vector<std::string>& behind, const std::vector<std::string>& all_names) {
  Faults faults;
  std::vector<std::string> own_names{"config", "help", "help-all", "version"};
  for (const Option& option : verb.options.options()) own_names.push_back(option.name);
  const std::string help = "see seqloop " + verb.name + " --help";
  bool after_unknown_flag = false;
  std::vector<std::string> words;
  for (const std::string& extra : extras) {
    // What follows an unknown flag is most likely its value.
    const bool flag = extra.starts_with('-');
    if (!flag && std::exchange(after_unknown_flag, false)) continue;
    after_unknown_flag = flag;
    if (!flag && verb.words) {
      words.push_back(extra);
      continue;
    }
    const std::string name = extra.substr(std::min(extra.find_first_not_of('-'), extra.size()));
    const std::string meant = nearest(name.substr(0, name.find('=')), own_names);
    std::error_code error;
    if (!flag && (meant.empty() || std::filesystem::exists(extra, error))) {
      faults.push_back({extra, "stands after no flag", "say what it is, as in --source; " + help});
    } else {
      faults.push_back({extra, "not known to '" + verb.name + "'",
                        meant.empty() ? help : "did you mean --" + meant + "?"});
    }
  }
  for (const std::string& word : behind) {
    words.push_back(word);
    if (!verb.words) faults.push_back({word, "stands after no flag", help});
  }
  if (verb.words) verb.words(std::move(words));
  std::set<std::string> set_already;
  for (const auto& [option, values] : given.values) {
    if (values.empty()) continue;
    set_already.insert(option->name);
    // A switch may well be turned on twice.
    const bool differ = option->kind != ValueKind::flag ||
                        std::ranges::count(values, values.front()) != std::ssize(values);
    if (values.size() > 1 && differ) faults.push_back({option->name, "given more than once"});
    for (Fault& fault : OptionTable::set(*option, values.front())) {
      faults.push_back(std::move(fault));
    }
  }
  if (given.config_files.size() > 1) faults.push_back({"config", "given more than once"});
  const std::string config = given.config_files.empty() ? "" : given.config_files.front();
  if (!given.config_files.empty() && config.empty()) {
    faults.push_back(empty_value("config"));
  } else if (!config.empty()) {
    for (Fault& fault : apply_config_file(config, verb.options, set_already, all_names)) {
      faults.push_back(std::move(fault));
    }
  }
  std::vector<FileUse> files = verb.options.files();
  files.push_back({"config", Access::reads, config});
  refuse_overwriting(faults, files);
  return faults;
}

/// What is behind `--flag=` is its value, also where that is nothing: CLI11 would take the next
/// word.
/// @param valued names of the flags that have one
std::vector<std::string> split_empty_values(std::span<char* const> words,
                                            const std::set<std::string>& valued) {
  std::vector<std::string> split;
  for (const std::string word : words) {
    if (word.starts_with("--") && word.ends_with('=') &&
        valued.contains(word.substr(2, word.size() - 3))) {
      split.push_back(word.substr(0, word.size() - 1));
      split.emplace_back();
    } else {
      split.push_back(word);
    }
  }
  return split;
}

int parse_and_run(int argc, char** argv, const std::vector<Verb>& verbs) {
  std::vector<std::string> all_names;
  std::set<std::string> valued{"config"};
  std::vector<Given> given(verbs.size());
  CLI::App app("Visual loop closure in fixed memory and bounded time",
               argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "seqloop");
  app.set_version_flag("--version", version_line());
  app.set_help_all_flag("--help-all", "Print all flags of all subcommands and exit");
  app.require_subcommand(1);
  const auto layout = std::make_shared<Layout>();
  layout->column_width(flags_width);
  app.formatter(layout);
  const auto asked = [&](std::string_view flag) {
    return std::find(argv, argv + argc, flag) != argv + argc;
  };
  // A flag that is hidden has no name in faults either: nothing is, unless help is asked for.
  const bool show_all = asked("--help-all") || !(asked("-h") || asked("--help"));
  for (std::size_t i = 0; i < verbs.size(); ++i) {
    add_to(app, verbs[i], given[i], show_all);
    for (const Option& option : verbs[i].options.options()) {
      all_names.push_back(option.name);
      if (option.kind != ValueKind::flag) valued.insert(option.name);
    }
  }
  if (const std::string_view first = argc > 1 ? argv[1] : "-"; !first.starts_with('-')) {
    std::vector<std::string> names;
    names.reserve(verbs.size());
    for (const Verb& verb : verbs) names.push_back(verb.name);
    if (std::ranges::find(names, first) == names.end()) {
      const std::string meant = nearest(first, names);
      throw SetupError({"'" + std::string(first) + "'", "no such subcommand",
                        meant.empty() ? "see seqloop --help" : "did you mean '" + meant + "'?"});
    }
  }
  char** const end = std::find(argv, argv + argc, std::string_view("--"));
  const std::vector<std::string> behind(std::min(end + 1, argv + argc), argv + argc);
  std::vector<std::string> words =
      split_empty_values(std::span(argv, end).subspan(argc > 0 ? 1 : 0), valued);
  std::ranges::reverse(words);  // as CLI11 wants them
  try {
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    say("command line: {}; see seqloop --help", error.what());
    return bad_usage;
  }
  for (std::size_t i = 0; i < verbs.size(); ++i) {
    const CLI::App* sub = app.get_subcommand(verbs[i].name);
    if (!sub->parsed()) continue;
    verbs[i].run(settle(verbs[i], given[i], sub->remaining(), behind, all_names));
  }
  return done;
}

/// A file that is opened must not become standard error because that was closed.
void keep_standard_streams() {
  // For reading only: what is written to a standard output that was closed is an error, not lost.
  for (int descriptor = open("/dev/null", O_RDONLY); descriptor >= 0;
       descriptor = open("/dev/null", O_RDONLY)) {
    if (descriptor <= STDERR_FILENO) continue;
    close(descriptor);
    return;
  }
}

/// What fails to be written is told of, and is no sudden death.
void ignore_write_signals() {
  std::signal(SIGPIPE, SIG_IGN);  // nobody reads any more
  std::signal(SIGXFSZ, SIG_IGN);  // the file is as large as the user may make one
}

int exit_code_of(int argc, char** argv, const std::vector<Verb>& verbs) {
  try {
    keep_standard_streams();
    ignore_write_signals();
    opencv::silence_opencv();
    const int exit_code = parse_and_run(argc, argv, verbs);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      throw std::system_error(errno, std::generic_category());
    }
    return exit_code;
  } catch (const SetupError& error) {
    for (const Fault& fault : error.faults()) {
      say("{}", to_string(in_flags(fault)));
    }
    return bad_usage;
  } catch (const std::bad_alloc&) {
    say("memory: there is not enough");
  } catch (const std::system_error& error) {
    // What prints does not say what it prints to.
    say("{}", std::ferror(stdout) != 0
                  ? "standard output: cannot be written: " + error.code().message()
                  : std::string(error.what()));
  } catch (const std::exception& error) {
    say("{}", error.what());
  }
  return failed_while_running;
}

}  // namespace

void run_program(int argc, char** argv, const std::vector<Verb>& verbs) {
  const int exit_code = exit_code_of(argc, argv, verbs);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  std::exit(exit_code);  // leaks are looked for on the way out
#else
  // Everything of ours is written and closed. Libraries are not asked to shut down: where memory is
  // short, OpenBLAS's threads look for some for ever, and it waits for them.
  std::_Exit(exit_code);
#endif
}

}  // namespace seqloop::program
