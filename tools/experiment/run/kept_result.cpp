// SPDX-License-Identifier: MIT
#include "experiment/run/kept_result.hpp"

#include <nlohmann/json.hpp>

#include "files/text_file.hpp"
#include "program/process/json_text.hpp"
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
  each("unknown", result.measures.unknown);
  each("accepted", result.measures.accepted);
  each("accepted_precision", result.measures.accepted_precision);
  each("accepted_recall", result.measures.accepted_recall);
  each("distances", result.distances);
  each("most_distances", result.most_distances);
  each("candidates", result.candidates);
  each("seconds", result.seconds);
  each("alone", result.alone);
  each("made_by", result.made_by);
  each("matrix", result.matrix);
}

// JSON has null where a number is not defined.

template <class Number>
Json written(const Number& number) {
  return number;
}
template <class Number>
Json written(const std::optional<Number>& number) {
  return number ? Json(*number) : Json(nullptr);
}

template <class Number>
void read(const Json& json, Number& number) {
  json.get_to(number);
}
void read(const Json& json, double& number) {
  number = json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}
template <class Number>
void read(const Json& json, std::optional<Number>& number) {
  number = json.is_null() ? std::nullopt : std::optional(json.get<Number>());
}

}  // namespace

void keep_result(const Result& result, const std::filesystem::path& file) {
  Json json{{"pair", result.pair}, {"method", result.method}, {"descriptor", result.descriptor}};
  for (const Setting& setting : result.settings) {
    json["settings"].push_back({setting.name, setting.value});
  }
  for_each_number(result,
                  [&](const char* name, const auto& number) { json[name] = written(number); });
  json["curve"] = Json::array();
  for (const evaluation::CurvePoint& point : result.measures.curve) {
    json["curve"].push_back({point.recall, point.precision});
  }
  for (const evaluation::ReliabilityBin& bin : result.measures.reliability) {
    json["reliability"].push_back({bin.count, bin.right, bin.probability_sum});
  }
  files::OutputFile out(file);
  out.write(program::json_text(json, 1) + '\n');
  out.commit();
}

std::optional<Result> kept_result(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  return parse_result(files::read_bytes(file));
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
    for_each_number(result, [&](const char* name, auto& number) { read(json.at(name), number); });
    for (const Json& point : json.at("curve")) {
      result.measures.curve.push_back({point.at(0), point.at(1)});
    }
    const Json& reliability = json.at("reliability");
    for (std::size_t bin = 0; bin < result.measures.reliability.size(); ++bin) {
      const Json& kept = reliability.at(bin);
      result.measures.reliability[bin] = {kept.at(0), kept.at(1), kept.at(2)};
    }
    return result;
  } catch (const Json::exception&) {
    return std::nullopt;  // somebody changed it: the run is done again
  }
}

}  // namespace seqloop::experiment
