// SPDX-License-Identifier: MIT
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "files/text_file.hpp"
#include "program/options/verb.hpp"
#include "program/process/interruption.hpp"
#include "program/verbs/all_verbs.hpp"
#include "program/watch/report_page.hpp"
#include "seqloop/files/output_file.hpp"

namespace seqloop::program {
namespace {

struct ReportSettings {
  std::filesystem::path run;
  std::filesystem::path summary;
  std::filesystem::path out;
  std::vector<std::string> words;  // without a flag in front
};

/// Adds a fault where a file cannot be read.
std::ifstream opened(const std::filesystem::path& file, const std::string& remedy, Faults& faults) {
  const std::size_t before = faults.size();
  collect(faults, [&] { files::refuse_empty(file, remedy); });
  if (faults.size() > before) return {};
  std::error_code error;
  const bool folder = std::filesystem::is_directory(file, error);
  errno = 0;
  std::ifstream stream;
  if (!folder) stream.open(file);
  if (!stream.is_open()) {
    faults.push_back(
        {file.string(),
         folder ? "is a folder" : "cannot be read: " + std::generic_category().message(errno),
         remedy});
  }
  return stream;
}

nlohmann::ordered_json conditions(const ReportSettings& settings, Faults& faults) {
  if (settings.summary.empty()) return {{"source", settings.run.filename().string()}};
  std::ifstream stream =
      opened(settings.summary, "name what `seqloop run --summary` wrote", faults);
  if (!stream.is_open()) return {};
  auto run = nlohmann::ordered_json::parse(stream, nullptr, false);
  const bool is_summary = run.is_object() && run.contains("budget_ms") &&
                          run["budget_ms"].is_object() && run.contains("source") &&
                          run["source"].is_string();
  if (!is_summary) {
    faults.push_back({"summary",
                      settings.summary.string() + " is not what `seqloop run --summary` writes",
                      "give the summary of that run, or leave --summary out"});
  } else {
    for (const char* counted : {"stages", "gates", "captured", "missed"}) run.erase(counted);
  }
  return run;
}

void report(const ReportSettings& settings, Faults faults) {
  take_interruptions();
  if (settings.run.empty())
    faults.push_back({"run", "not given", "name what `seqloop run --out` wrote"});
  // The first word is the run, unless --run says otherwise.
  const bool two = !settings.words.empty() && settings.run != settings.words.front();
  if (two || settings.words.size() > 1)
    faults.push_back({"report", "more than one run is given", "seqloop report RUN --out PAGE"});
  if (settings.out.empty())
    faults.push_back({"out", "not given", "name the page to write, --out page.html"});
  auto run = conditions(settings, faults);
  std::ifstream lines;
  if (!settings.run.empty()) {
    lines = opened(settings.run, "name what `seqloop run --out` wrote", faults);
  }
  std::optional<files::OutputFile> out;
  if (!settings.out.empty()) collect(faults, [&] { out.emplace(settings.out); });
  refuse(std::move(faults));
  const std::string page = report_page(lines, settings.run.string(), std::move(run));
  out->write(page);
  out->commit();
}

}  // namespace

Verb report_verb() {
  const auto settings = std::make_shared<ReportSettings>();
  Verb verb{"report",
            "Make a page of a run that is over",
            {},
            [settings](Faults faults) { report(*settings, std::move(faults)); },
            {}};
  verb.options.path("run", Access::reads, settings->run,
                    "lines that `seqloop run --out` wrote; the flag itself may be left out");
  verb.options.path("summary", Access::reads, settings->summary,
                    "what `seqloop run --summary` wrote of the same run: budget, method [none]");
  verb.options.path("out", Access::writes, settings->out, "the page, one HTML file");
  verb.words = [settings](const std::vector<std::string>& words) {
    if (!words.empty()) settings->run = words.front();
    settings->words = words;
  };
  return verb;
}

}  // namespace seqloop::program
