#include "bench/cli/report_schema.h"

#include <nlohmann/json.hpp>

#include "bench/evaluation/measures/picture_measures.h"
#include "bench/output/report_parts.h"
#include "bench/results/counts.h"
#include "bench/results/times.h"
#include "bench/studies/latency/latency_spans_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

const Json kPart = {{"$ref", "#/$defs/part"}};

Json schema_of(const Measure& measure) {
  return {{"title", measure.title},
          {"description", measure.help},
          {"unit", unit_of(measure.key).name},
          {"$ref", "#/$defs/figure"}};
}

/// An object that has all of these.
Json schema_of(const Measurements& found) {
  Json properties, required = Json::array();
  for (const MeasuredValue& one : found) {
    properties[one.name] = schema_of(*one.measure);
    required.push_back(one.name);
  }
  return {{"type", "object"},
          {"required", required},
          {"properties", properties},
          {"additionalProperties", kPart}};
}

/// Wherever a figure with a unit stands, it is one. Keys without one, as "samples", also name
/// parts.
Json figures_with_units() {
  Json properties;
  for (const Chosen list :
       {Chosen(picture_measures()), Chosen(times::kAll), Chosen(counts::kAll)}) {
    for (const Measure* measure : list) {
      if (*unit_of(measure->key).name != '\0') properties[measure->key] = schema_of(*measure);
    }
  }
  return properties;
}

Json list_of(const Json& items) {
  return {{"type", "array"}, {"items", items}};
}

Json definitions() {
  const Json number = {{"type", {"number", "null"}}};
  Json interval = {{"type", "object"}, {"additionalProperties", number}};
  interval["anyOf"] = {{{"required", {"value", "low", "high"}}},
                       {{"required", {"mean", "half_interval", "n"}}},
                       {{"required", {"median", "min", "max"}}}};
  const Json text = {{"type", {"string", "null"}}};
  const Json check = {{"type", "object"},
                      {"required", {"name", "asked", "limit", "value", "held", "because"}},
                      {"properties",
                       {{"name", {{"type", "string"}}},
                        {"asked", text},
                        {"limit", number},
                        {"value", number},
                        {"held", {{"type", {"boolean", "null"}}}},
                        {"because", text}}}};
  const Json part = {
      {"properties", figures_with_units()}, {"additionalProperties", kPart}, {"items", kPart}};
  // One value, with its interval or spread, or those of several measurements.
  return {{"figure", {{"anyOf", {number, interval, list_of(number)}}}},
          {"check", check},
          {"part", part}};
}

}  // namespace

std::string report_schema(const std::vector<std::string>& commands) {
  const Json text = {{"type", "string"}};
  Json error = schema_of(described(PictureMeasures(), ExpectedSurface()));
  Json errors = {{"anyOf", {{{"type", "null"}}, std::move(error)}}};
  const Json of_stream = {
      {"if", {{"properties", {{"command", {{"const", "stream"}}}}}}},
      {"then",
       {{"properties",
         {{"timing", {{"properties", {{"latency", schema_of(described(StreamSummary()))}}}}}}}}}};
  return report_text(
      {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
       {"title", "report.json of wobblebench"},
       {"type", "object"},
       {"required", {"schema", "command", "provenance", "checks", "warnings"}},
       {"properties",
        {{"schema", {{"const", kReportSchema}}},
         {"command", {{"enum", commands}}},
         {"provenance",
          {{"type", "object"}, {"required", {"commit", "host", "cpu", "threads", "gl_renderer"}}}},
         {"scene", {{"type", {"object", "null"}}}},
         {"effects", list_of(text)},
         {"checks", list_of({{"$ref", "#/$defs/check"}})},
         {"warnings", list_of(text)},
         {"error", errors}}},
       {"additionalProperties", kPart},
       {"allOf", Json::array({of_stream})},
       {"$defs", definitions()}});
}

}  // namespace wobblebench::bench
