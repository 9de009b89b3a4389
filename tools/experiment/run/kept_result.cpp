// SPDX-License-Identifier: MIT
#include "experiment/run/kept_result.hpp"

#include <nlohmann/json.hpp>

#include "files/text_file.hpp"
#include "seqloop/files/output_file.hpp"

namespace seqloop::experiment {
namespace {

using Json = nlohmann::ordered_json;

/// The numbers of a result under their names, for both ways. `each(name, number)`.
template <class AResult, class Each>
void for_each_number(AResult& result, Each each) {
  each("places", result.places);
  each("queries", result.queries);
  each("frames", result.frames);
  each("descriptor_size", result.descriptor_size);
  each("answered", result.measures.answered);
  each("correct", result.measures.correct);
  each("precision", result.measures.precision);
  each("recall", result.measures.recall);
  each("recall_at_100_precision", result.measures.recall_at_100_precision);
  each("area_under_curve", result.measures.area_under_curve);
  each("distances", result.distances);
  each("most_distances", result.most_distances);
  each("candidates", result.candidates);
  each("seconds", result.seconds);
  each("alone", result.alone);
  each("made_by", result.made_by);
  each("matrix", result.matrix);
}

}  // namespace

void keep_result(const Result& result, const std::filesystem::path& file) {
  Json json{{"pair", result.pair}, {"method", result.method}, {"descriptor", result.descriptor}};
  for (const Setting& setting : result.settings) {
    json["settings"].push_back({setting.name, setting.value});
  }
  for_each_number(result, [&](const char* name, const auto& number) { json[name] = number; });
  json["curve"] = Json::array();
  for (const evaluation::CurvePoint& point : result.measures.curve) {
    json["curve"].push_back({point.recall, point.precision});
  }
  files::OutputFile out(file);
  out.write(json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n');
  out.commit();
}

std::optional<Result> kept_result(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  return parse_result(files::read_text(file));
}

std::optional<Result> parse_result(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    Result result;
    json.at("pair").get_to(result.pair);
    json.at("method").get_to(result.method);
    json.at("descriptor").get_to(result.descriptor);
    if (json.contains("settings")) {
      for (const Json& setting : json.at("settings")) {
        result.settings.push_back({setting.at(0), setting.at(1)});
      }
    }
    for_each_number(result, [&](const char* name, auto& number) { json.at(name).get_to(number); });
    for (const Json& point : json.at("curve")) {
      result.measures.curve.push_back({point.at(0), point.at(1)});
    }
    return result;
  } catch (const Json::exception&) {
    return std::nullopt;  // somebody changed it: the run is done again
  }
}

}  // namespace seqloop::experiment
