#include "bench/output/document/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/number_text.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "https://vega.github.io/schema/vega-lite/v6.json";

constexpr int kWidth = 420;  // of a plot, pixels; a page fits it to its own

/// Okabe and Ito's palette, distinguishable with any colour vision; its black is a grey that shows
/// on white and on black.
constexpr std::array kPalette = {
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#808080"};

const char* colour_of(const Series& series, std::size_t number) {
  const std::size_t index = series.colour < 0 ? number : static_cast<std::size_t>(series.colour);
  return kPalette[index % kPalette.size()];
}

const char* shape_of(Mark mark) {
  switch (mark) {
    case Mark::none:
      return "stroke";
    case Mark::square:
      return "square";
    case Mark::triangle:
      return "triangle-up";
    case Mark::diamond:
      return "diamond";
    default:
      return "circle";
  }
}

Json dashes_of(Stroke stroke) {
  return stroke == Stroke::dashed ? Json::array({7, 4}) : Json::array({1, 0});
}

/// Null where the axis has no place for it; seven digits are more than a picture shows.
Json shown(double value, const Axis& axis) {
  constexpr int kDigits = 7;
  const bool has_place = std::isfinite(value) && (axis.scale == Scale::linear || value > 0);
  return has_place ? Json(std::stod(significant(value, kDigits))) : Json(nullptr);
}

/// What tells a series from the others in the data: its name, unless it has none or an earlier one
/// has it.
std::vector<std::string> keys_of(const std::vector<Series>& all) {
  std::vector<std::string> keys;
  for (const Series& series : all) {
    const bool taken = std::find(keys.begin(), keys.end(), series.name) != keys.end();
    const bool named = !series.name.empty() && !taken;
    keys.push_back(named ? series.name : "(series " + std::to_string(keys.size() + 1) + ")");
  }
  return keys;
}

/// Of the whole number next to `value`.
std::string name_at(const std::vector<std::string>& names, double value) {
  const long index = std::lround(value);
  return index < 0 || index >= std::ssize(names) ? "" : names[static_cast<std::size_t>(index)];
}

Json point_json(const Chart& chart, const Series& series, const std::string& key, std::size_t i) {
  Json point = {{"series", key},
                {"i", i},
                {"x", shown(series.x[i], chart.x)},
                {"y", shown(series.y.at(i), chart.y)}};
  if (!series.low.empty()) {
    point["low"] = shown(series.low.at(i), chart.y);
    point["high"] = shown(series.high.at(i), chart.y);
  }
  if (!series.ids.empty()) point["id"] = series.ids.at(i);
  if (!series.notes.empty()) point["note"] = series.notes.at(i);
  if (!chart.x.names.empty()) point["at"] = name_at(chart.x.names, series.x[i]);
  return point;
}

/// The points of the series that `wanted` chooses.
template <class Wanted>
Json points_of(const Chart& chart, const Wanted& wanted) {
  const auto keys = keys_of(chart.series);
  Json points = Json::array();
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    const Series& series = chart.series[s];
    if (!wanted(series)) continue;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      points.push_back(point_json(chart, series, keys[s], i));
    }
  }
  return points;
}

/// Room for the names 0 to n - 1.
Json names_scale_json(const Axis& axis) {
  constexpr double kMargin = 0.6;
  const double last = static_cast<double>(axis.names.size()) - 1;
  return {{"type", "linear"},
          {"zero", false},
          {"nice", false},
          {"domain", Json::array({-kMargin, last + kMargin})}};
}

Json scale_json(const Axis& axis) {
  if (!axis.names.empty()) return names_scale_json(axis);
  Json scale = {{"type", axis.scale == Scale::logarithmic ? "log" : "linear"}, {"zero", false}};
  if (axis.scale == Scale::logarithmic) scale.erase("zero");
  if (axis.low) scale["domainMin"] = *axis.low;
  if (axis.high) scale["domainMax"] = *axis.high;
  if (!axis.low && !axis.high) scale["nice"] = true;
  return scale;
}

/// Long names stand aslant below a horizontal axis.
Json names_axis_json(const std::vector<std::string>& names) {
  constexpr int kDegrees = -30;
  Json numbers = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i) numbers.push_back(i);
  return {{"values", numbers},
          {"labelExpr", Json(names).dump() + "[datum.value]"},
          {"labelAngle", kDegrees},
          {"labelOverlap", false},
          {"labelLimit", 0},
          {"grid", false}};
}

Json position_json(const char* field, const Axis& axis) {
  Json look = Json::object();
  if (!axis.ticks.empty()) look["values"] = axis.ticks;
  if (!axis.names.empty()) look = names_axis_json(axis.names);
  return {{"field", field},
          {"type", "quantitative"},
          {"title", axis.label},
          {"scale", scale_json(axis)},
          {"axis", look}};
}

/// How series are told apart: one legend for colour, shape and dashes.
class Legend {
 public:
  explicit Legend(const Chart& chart) {
    const auto keys = keys_of(chart.series);
    for (std::size_t s = 0; s < chart.series.size(); ++s) {
      const Series& series = chart.series[s];
      add(keys[s], colour_of(series, s), shape_of(series.mark), dashes_of(series.stroke));
      if (keys[s] == series.name) named_.push_back(series.name);
    }
  }

  Json colour() const { return encoding(colours_); }
  Json shape() const { return encoding(shapes_); }
  Json dash() const { return encoding(dashes_); }

 private:
  void add(const std::string& key, const char* colour, const char* shape, const Json& dashes) {
    keys_.push_back(key);
    colours_.push_back(colour);
    shapes_.push_back(shape);
    dashes_.push_back(dashes);
  }
  Json encoding(const Json& range) const {
    const Json legend =
        named_.empty()
            ? Json(nullptr)
            : Json{
                  {"values", named_}, {"symbolOpacity", 1}, {"symbolSize", 150}, {"labelLimit", 0}};
    return {{"field", "series"},
            {"type", "nominal"},
            {"title", nullptr},
            {"scale", {{"domain", keys_}, {"range", range}}},
            {"legend", legend}};
  }

  Json keys_ = Json::array(), named_ = Json::array(), colours_ = Json::array(),
       shapes_ = Json::array(), dashes_ = Json::array();
};

Json tooltip_field(const char* field, const std::string& title, bool number) {
  Json json = {{"field", field}, {"type", number ? "quantitative" : "nominal"}, {"title", title}};
  if (number) json["format"] = ".4~g";
  return json;
}

Json tooltip(const Chart& chart) {
  const auto any = [&](const auto& has) {
    return std::any_of(chart.series.begin(), chart.series.end(), has);
  };
  const bool named = !chart.x.names.empty();
  Json fields = Json::array({tooltip_field("series", "series", false),
                             tooltip_field(named ? "at" : "x", chart.x.label, !named),
                             tooltip_field("y", chart.y.label, true)});
  if (any([](const Series& series) { return !series.low.empty(); })) {
    fields.push_back(tooltip_field("low", "from", true));
    fields.push_back(tooltip_field("high", "to", true));
  }
  if (any([](const Series& series) { return !series.notes.empty(); })) {
    fields.push_back(tooltip_field("note", "of", false));
  }
  return fields;
}

/// The layers of a chart, the lowest first.
class Layers {
 public:
  Layers(const Chart& chart, std::string selection)
      : chart_(chart), legend_(chart), selection_(std::move(selection)) {}

  Json json() {
    add_lines();
    add_intervals();
    add_marks();
    return layers_;
  }

 private:
  Json place() const {
    return {{"x", position_json("x", chart_.x)}, {"y", position_json("y", chart_.y)}};
  }
  /// Faint where the legend's choice is another series.
  Json opacity(double full) const {
    constexpr double kFaint = 0.1;
    return {{"condition", {{"param", selection_}, {"value", full}}}, {"value", kFaint}};
  }
  void add(const Json& mark, const Json& values, const Json& encoding) {
    if (values.empty()) return;
    Json layer = {{"data", {{"values", values}}}, {"mark", mark}, {"encoding", encoding}};
    if (layers_.empty()) {
      layer["params"] = Json::array({{{"name", selection_},
                                      {"select", {{"type", "point"}, {"fields", {"series"}}}},
                                      {"bind", "legend"}}});
    }
    layers_.push_back(std::move(layer));
  }
  void add_lines() {
    Json encoding = place();
    encoding["color"] = legend_.colour();
    encoding["strokeDash"] = legend_.dash();
    encoding["order"] = {{"field", "i"}, {"type", "quantitative"}};
    encoding["opacity"] = opacity(1);
    const auto drawn = [](const Series& series) { return series.stroke != Stroke::none; };
    add({{"type", "line"}, {"strokeWidth", 1.8}}, points_of(chart_, drawn), encoding);
  }
  void add_intervals() {
    Json encoding = place();
    encoding["y"]["field"] = "low";
    encoding["y2"] = {{"field", "high"}};
    encoding["color"] = legend_.colour();
    encoding["opacity"] = opacity(0.7);
    const auto has_interval = [](const Series& series) { return !series.low.empty(); };
    add({{"type", "rule"}, {"strokeWidth", 1.2}}, points_of(chart_, has_interval), encoding);
  }
  void add_marks() {
    Json encoding = place();
    encoding["color"] = legend_.colour();
    encoding["shape"] = legend_.shape();
    encoding["opacity"] = opacity(1);
    encoding["tooltip"] = tooltip(chart_);
    for (const bool filled : {false, true}) {
      const auto marked = [filled](const Series& series) {
        return series.mark != Mark::none && (series.mark != Mark::ring) == filled;
      };
      add({{"type", "point"}, {"filled", filled}, {"size", 55}},
          points_of(chart_, marked),
          encoding);
    }
  }

  const Chart& chart_;
  Legend legend_;
  std::string selection_;
  Json layers_ = Json::array();
};

/// Where there is no value: a text in the place of the plot.
Json nothing_json() {
  return {{"data", {{"values", Json::array({Json::object()})}}},
          {"mark", {{"type", "text"}, {"text", "nothing to show"}}}};
}

bool has_place(const Json& value) {
  return !value.at("x").is_null() && !value.at("y").is_null();
}

bool shows_anything(const Json& layers) {
  return std::any_of(layers.begin(), layers.end(), [](const Json& layer) {
    const Json& values = layer.at("data").at("values");
    return std::any_of(values.begin(), values.end(), has_place);
  });
}

Json panel_json(const Chart& chart, const std::string& selection) {
  Json panel = {{"title", chart.title}, {"width", kWidth}, {"height", 300}};
  const Json layers = Layers(chart, selection).json();
  if (shows_anything(layers)) {
    panel["layer"] = layers;
  } else {
    panel.update(nothing_json());
  }
  return panel;
}

Json panel_json(const BarChart& chart, const std::string& selection) {
  Json values = Json::array(), names = Json::array(), colours = Json::array();
  for (std::size_t p = 0; p < chart.parts.size(); ++p) {
    names.push_back(chart.parts[p].name);
    colours.push_back(kPalette[p % kPalette.size()]);
    for (std::size_t r = 0; r < chart.rows.size(); ++r) {
      values.push_back({{"row", chart.rows[r]},
                        {"part", chart.parts[p].name},
                        {"i", p},
                        {"value", shown(chart.parts[p].values.at(r), Axis{})}});
    }
  }
  const Json row = {{"field", "row"},
                    {"type", "nominal"},
                    {"sort", nullptr},
                    {"title", nullptr},
                    {"axis", {{"labelLimit", 220}}}};
  const Json value = {{"field", "value"}, {"type", "quantitative"}, {"title", chart.label}};
  const Json legend = chart.parts.size() < 2
                          ? Json(nullptr)
                          : Json{{"labelLimit", 0}, {"orient", "bottom"}, {"columns", 3}};
  const Json part = {{"field", "part"},
                     {"type", "nominal"},
                     {"title", nullptr},
                     {"scale", {{"domain", names}, {"range", colours}}},
                     {"legend", legend}};
  return {{"title", chart.title},
          {"width", kWidth},
          {"height", {{"step", 28}}},
          {"data", {{"values", values}}},
          {"mark", {{"type", "bar"}}},
          {"params",
           Json::array({{{"name", selection},
                         {"select", {{"type", "point"}, {"fields", {"part"}}}},
                         {"bind", "legend"}}})},
          {"encoding",
           {{"y", row},
            {"x", value},
            {"color", part},
            {"order", {{"field", "i"}, {"type", "quantitative"}}},
            {"opacity", {{"condition", {{"param", selection}, {"value", 1}}}, {"value", 0.1}}},
            {"tooltip",
             Json::array({tooltip_field("row", "of", false),
                          tooltip_field("part", "part", false),
                          tooltip_field("value", chart.label, true)})}}}};
}

Json with_schema(const Json& panel) {
  Json all = {{"$schema", kSchema}};
  all.update(panel);
  return all;
}

}  // namespace

Json specification(const Chart& chart) {
  return with_schema(panel_json(chart, "shown"));
}

Json specification(const BarChart& chart) {
  return with_schema(panel_json(chart, "shown"));
}

Json specification(const Figure& figure) {
  Json panels = Json::array();
  for (const auto& panel : figure.panels) {
    const std::string selection = "shown_" + std::to_string(panels.size() + 1);
    panels.push_back(
        std::visit([&](const auto& chart) { return panel_json(chart, selection); }, panel));
  }
  constexpr int kColumns = 2;
  Json all = {{"concat", panels}, {"columns", kColumns}};
  all["resolve"]["scale"] = {
      {"color", "independent"}, {"shape", "independent"}, {"strokeDash", "independent"}};
  return with_schema(all);
}

}  // namespace wobblebench::bench
