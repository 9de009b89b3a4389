// SPDX-License-Identifier: MIT
#include "program/command_line.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <set>
#include <utility>

#include "program/options/config_file.hpp"
#include "program/options/flag_names.hpp"
#include "program/process/build_info.hpp"
#include "program/process/say.hpp"
#include "seqloop/opencv/silence.hpp"

namespace seqloop::program {
namespace {

enum ExitCode : int { done = 0, failed_while_running = 1, bad_usage = 2 };

/// What the command line says of one verb, as text.
struct Given {
  std::vector<std::pair<const Option*, std::vector<std::string>>> values;
  std::string config_file;
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

void add_to(CLI::App& app, const Verb& verb, Given& given) {
  CLI::App* sub = app.add_subcommand(verb.name, verb.help);
  sub->allow_extras();
  sub->add_option("--config", given.config_file, "settings from a TOML file; flags win over it");
  given.values.reserve(verb.options.options().size());
  for (const Option& option : verb.options.options()) {
    auto& [known, values] = given.values.emplace_back();
    known = &option;
    if (option.kind == ValueKind::flag) {
      sub->add_flag_callback(
          "--" + option.name, [&into = values] { into = {"true"}; }, option.help);
    } else {
      sub->add_option("--" + option.name, values, option.help)
          ->type_name(value_name(option.kind))
          ->expected(1)
          ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    }
  }
}

/// Everything that the command line and the configuration file get wrong, at once.
Faults settle(const Verb& verb, const Given& given, const std::vector<std::string>& extras,
              const std::vector<std::string>& all_names) {
  Faults faults;
  std::vector<std::string> own_names{"config"};
  for (const Option& option : verb.options.options()) own_names.push_back(option.name);
  bool after_unknown_flag = false;
  for (const std::string& extra : extras) {
    // What follows an unknown flag is most likely its value.
    const bool flag = extra.starts_with('-');
    if (!flag && std::exchange(after_unknown_flag, false)) continue;
    after_unknown_flag = flag;
    const std::string name = extra.substr(std::min(extra.find_first_not_of('-'), extra.size()));
    const std::string meant = nearest(name.substr(0, name.find('=')), own_names);
    faults.push_back(
        {extra, "not known to '" + verb.name + "'",
         meant.empty() ? "see seqloop " + verb.name + " --help" : "did you mean --" + meant + "?"});
  }
  std::set<std::string> set_already;
  for (const auto& [option, values] : given.values) {
    if (values.empty()) continue;
    set_already.insert(option->name);
    if (values.size() > 1) faults.push_back({option->name, "given more than once"});
    for (Fault& fault : OptionTable::set(*option, values.front())) {
      faults.push_back(std::move(fault));
    }
  }
  if (!given.config_file.empty()) {
    for (Fault& fault :
         apply_config_file(given.config_file, verb.options, set_already, all_names)) {
      faults.push_back(std::move(fault));
    }
  }
  std::vector<FileUse> files = verb.options.files();
  files.push_back({"config", Access::reads, given.config_file});
  refuse_overwriting(faults, files);
  return faults;
}

int parse_and_run(int argc, char** argv, const std::vector<Verb>& verbs) {
  std::vector<std::string> all_names;
  std::vector<Given> given(verbs.size());
  CLI::App app("Visual loop closure in fixed memory and bounded time", "seqloop");
  app.set_version_flag("--version", version_line());
  app.require_subcommand(1);
  for (std::size_t i = 0; i < verbs.size(); ++i) {
    add_to(app, verbs[i], given[i]);
    app.get_subcommand(verbs[i].name)->set_version_flag("--version", app.version());
    for (const Option& option : verbs[i].options.options()) all_names.push_back(option.name);
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
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    say("command line: {}; see seqloop --help", error.what());
    return bad_usage;
  }
  for (std::size_t i = 0; i < verbs.size(); ++i) {
    const CLI::App* sub = app.get_subcommand(verbs[i].name);
    if (!sub->parsed()) continue;
    verbs[i].run(settle(verbs[i], given[i], sub->remaining(), all_names));
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
      throw std::runtime_error("standard output: cannot be written");
    }
    return exit_code;
  } catch (const SetupError& error) {
    for (const Fault& fault : error.faults()) {
      say("{}", to_string(in_flags(fault)));
    }
    return bad_usage;
  } catch (const std::bad_alloc&) {
    say("memory: there is not enough");
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
