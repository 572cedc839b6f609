#include "bench/studies/dataset/dataset_report.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/file.h"
#include "base/statistics.h"
#include "bench/output/image_io.h"
#include "bench/output/picture/canvas.h"
#include "bench/output/report_parts.h"
#include "bench/results/error.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kManifest = "manifest.jsonl";
constexpr const char* kSheet = "contact_sheet.png";
constexpr int kMostShown = 48, kMostAcross = 4;
constexpr int kSide = 150, kGap = 12, kLeft = 110, kCaption = 20;
constexpr double kText = 13;

SceneFigures figures_of(const PopulationPlan& plan, int index, const Json& line) {
  SceneFigures figures{.index = index,
                       .stratum = plan.stratum_of[static_cast<std::size_t>(index)],
                       .refusal = line.value("refused", ""),
                       .bytes = line.at("bytes").get<double>()};
  if (!line.contains("error") || line["error"].is_null()) return figures;
  const Json& error = line["error"];
  figures.measured = true;
  for (const Measure* one : shown_figures()) {
    const Json& found = error.at(one->key);
    figures.values.push_back(found.is_number() ? found.get<double>() : kUnset);
  }
  return figures;
}

/// Of one stratum: the scenes with a picture.
std::vector<const SceneFigures*> measured_of(const std::vector<SceneFigures>& figures,
                                             std::size_t stratum) {
  std::vector<const SceneFigures*> measured;
  for (const SceneFigures& one : figures) {
    if (one.stratum == stratum && one.measured) measured.push_back(&one);
  }
  return measured;
}

int refused_of(const std::vector<SceneFigures>& figures, std::size_t stratum) {
  return static_cast<int>(std::ranges::count_if(figures, [&](const SceneFigures& one) {
    return one.stratum == stratum && !one.refusal.empty();
  }));
}

/// Median over the scenes, and the quartiles beside it.
Cell spread_cell(const std::vector<const SceneFigures*>& scenes, std::size_t figure) {
  std::vector<double> values;
  for (const SceneFigures* one : scenes) {
    if (std::isfinite(one->values[figure])) values.push_back(one->values[figure]);
  }
  if (values.empty()) return {};
  const Quartiles quartiles = quartiles_of(values);
  return Cell::spread(quartiles.median, quartiles.lower, quartiles.upper);
}

/// The scene of the greatest magnitude, or of none; null: no scenes.
const SceneFigures* worst_of(const std::vector<const SceneFigures*>& scenes, std::size_t figure) {
  const SceneFigures* worst = nullptr;
  for (const SceneFigures* one : scenes) {
    const double value = one->values[figure];
    if (!std::isfinite(value)) return one;
    if (worst == nullptr || std::abs(value) > std::abs(worst->values[figure])) worst = one;
  }
  return worst;
}

constexpr std::size_t kP95Shown = 1;  ///< in shown_figures()

Table strata_table(const PopulationPlan& plan, const std::vector<SceneFigures>& figures) {
  Table table{.name = "strata",
              .caption = "Median over the scenes (quartiles), and the scene of the greatest P95.",
              .columns = columns_of({{"stratum"}, {"scenes"}, {"refused"}}, shown_figures())};
  table.columns.push_back({"worst_p95_mm", "worst P95", "mm"});
  table.columns.push_back({"worst_scene", "of scene"});
  for (std::size_t i = 0; i < plan.strata.size(); ++i) {
    const auto scenes = measured_of(figures, i);
    std::vector<Cell> row = {plan.strata[i].name, plan.strata[i].scenes, refused_of(figures, i)};
    for (std::size_t j = 0; j < shown_figures().size(); ++j) row.push_back(spread_cell(scenes, j));
    const SceneFigures* const worst = worst_of(scenes, kP95Shown);
    row.push_back(worst == nullptr ? Cell() : worst->values[kP95Shown]);
    row.push_back(worst == nullptr ? Cell() : worst->index);
    table.add(std::move(row));
  }
  return table;
}

/// Each figure over all scenes.
KeyFigures answer_of(const PopulationPlan& plan, const std::vector<SceneFigures>& figures) {
  std::vector<const SceneFigures*> scenes;
  for (const SceneFigures& one : figures) {
    if (one.measured) scenes.push_back(&one);
  }
  KeyFigures answer;
  for (std::size_t i = 0; i < shown_figures().size() && !scenes.empty(); ++i) {
    const Measure& measure = *shown_figures()[i];
    const SceneFigures& worst = *worst_of(scenes, i);
    answer.add(measure.title,
               spread_cell(scenes, i).number(),
               measure.key,
               std::string(measure.help) + ": median of the scenes; greatest " +
                   Cell(worst.values[i]).shown(column_of(measure)) + " of scene " +
                   std::to_string(worst.index) + ", " + plan.strata[worst.stratum].name);
  }
  return answer;
}

Table refusal_table(const PopulationPlan& plan, const std::vector<SceneFigures>& figures) {
  constexpr std::size_t kMostRows = 100;
  Table table{.name = "refused", .columns = {{"scene"}, {"stratum"}, {"line"}}};
  for (const SceneFigures& one : figures) {
    if (one.refusal.empty() || table.rows.size() == kMostRows) continue;
    table.add({one.index, plan.strata[one.stratum].name, one.refusal});
  }
  return table;
}

/// A scene of the contact sheet.
struct ShownScene {
  const SceneFigures* figures;
  std::string name;  ///< of its folder
  Image<glm::vec3> truth, found;
};

/// The first scenes of each stratum that were made: a row a stratum.
std::vector<std::vector<ShownScene>> shown_scenes(const PopulationPlan& plan,
                                                  const DatasetFolder& folder,
                                                  const std::vector<SceneFigures>& figures) {
  const auto across = static_cast<std::size_t>(
      std::clamp(kMostShown / static_cast<int>(plan.strata.size()), 1, kMostAcross));
  std::vector<std::vector<ShownScene>> rows(std::min<std::size_t>(plan.strata.size(), kMostShown));
  for (const SceneFigures& one : figures) {
    if (one.stratum >= rows.size() || !one.refusal.empty()) continue;
    auto& row = rows[one.stratum];
    if (row.size() == across) continue;
    const fs::path of = folder.scene(one.index);
    row.push_back(
        {&one, of.filename().string(), read_png(of / "truth.png"), read_png(of / "surface.png")});
  }
  return rows;
}

void draw(Canvas& canvas, const Point2& corner, const Image<glm::vec3>& picture) {
  const Box2 box{corner, corner + Point2(kSide, kSide)};
  if (picture.pixels.empty()) {
    canvas.text((box.low + box.high) * 0.5, "none", {.size = kText, .across = 0.5});
  } else {
    canvas.picture(box, picture);
  }
}

/// The truth and what was found, side by side.
void draw_pair(Canvas& canvas, const Point2& corner, const ShownScene& shown) {
  draw(canvas, corner, shown.truth);
  draw(canvas, corner + Point2(kSide, 0), shown.found);
}

/// A row a stratum.
Image<glm::vec3> contact_sheet(const PopulationPlan& plan,
                               const std::vector<std::vector<ShownScene>>& rows) {
  std::size_t across = 1;
  for (const auto& row : rows) across = std::max(across, row.size());
  constexpr int kRow = kCaption + kSide + kGap, kCell = 2 * kSide + kGap;
  Canvas canvas(kLeft + static_cast<int>(across) * kCell, kRow * static_cast<int>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double top = kRow * static_cast<double>(i);
    canvas.text({kGap, top + kCaption + 0.5 * kSide}, plan.strata[i].name, {.size = kText});
    for (std::size_t j = 0; j < rows[i].size(); ++j) {
      const double left = kLeft + static_cast<double>(j) * kCell;
      canvas.text({left + kSide, top + 0.5 * kCaption},
                  rows[i][j].name + ": truth, found",
                  {.size = kText, .across = 0.5});
      draw_pair(canvas, {left, top + kCaption}, rows[i][j]);
    }
  }
  return canvas.finish();
}

Image<glm::vec3> pair_picture(const ShownScene& shown) {
  Canvas canvas(2 * kSide, kSide);
  draw_pair(canvas, {0, 0}, shown);
  return canvas.finish();
}

/// What was drawn for a scene, as a list.
std::string settings_text(const Json& line) {
  std::string text;
  for (const auto& [key, value] : line.at("settings").items()) {
    text += "- `" + key + "` " + value.dump() + "\n";
  }
  return text;
}

void add_shown(const PopulationPlan& plan,
               const DatasetFolder& folder,
               const std::vector<std::vector<ShownScene>>& rows,
               OutputFolder& out,
               Document& document) {
  Table table{.name = "scenes",
              .caption = "Scenes of the contact sheet; choose a row to see what was drawn.",
              .columns = columns_of({{"scene"}, {"stratum"}}, shown_figures())};
  std::vector<Detail> details;
  for (const auto& row : rows) {
    for (const ShownScene& shown : row) {
      const SceneFigures& one = *shown.figures;
      const Json line = folder.line(one.index);
      const std::string file = "scene_" + shown.name + ".png";
      write_png(out.stage(file), pair_picture(shown));
      std::vector<Cell> cells = {shown.name, plan.strata[one.stratum].name};
      cells.insert(cells.end(), one.values.begin(), one.values.end());
      cells.resize(2 + shown_figures().size());
      table.add(std::move(cells), shown.name);
      details.push_back({.id = shown.name,
                         .title = "Scene " + shown.name + ", " + plan.strata[one.stratum].name +
                                  ": truth and what was found",
                         .command = line.at("command").get<std::string>(),
                         .text = settings_text(line),
                         .picture_file = file});
    }
  }
  document.add(std::move(table));
  for (Detail& detail : details) document.add(std::move(detail));
}

double mean_bytes(const std::vector<SceneFigures>& figures) {
  double sum = 0, made = 0;
  for (const SceneFigures& one : figures) {
    if (!one.refusal.empty()) continue;
    sum += one.bytes;
    ++made;
  }
  return made > 0 ? sum / made : 0;
}

int refused_in_all(const std::vector<SceneFigures>& figures) {
  return static_cast<int>(
      std::ranges::count_if(figures, [](const SceneFigures& one) { return !one.refusal.empty(); }));
}

std::string head_text(const PopulationPlan& plan, const std::vector<SceneFigures>& figures) {
  return "**" + std::to_string(plan.scenes) + " scenes** of " + std::to_string(plan.strata.size()) +
         " strata, **" + std::to_string(refused_in_all(figures)) + " refused**. All sticks are " +
         "simulated. `" + kManifest +
         "` has a line for each, with what was drawn, the measures of the face, hashes of the "
         "files and the command that makes it again; the files are in `scenes/NUMBER/`.";
}

}  // namespace

Chosen shown_figures() {
  static constexpr const Measure* kShown[] = {
      &error::kMedian, &error::kP95, &error::kMissed, &error::kFalse};
  return kShown;
}

std::vector<SceneFigures> stage_manifest(const PopulationPlan& plan,
                                         const DatasetFolder& folder,
                                         OutputFolder& out) {
  const fs::path path = out.stage(kManifest);
  std::ofstream manifest(path, std::ios::binary);
  std::vector<SceneFigures> figures;
  for (int i = 0; i < plan.scenes; ++i) {
    const Json line = folder.line(i);
    manifest << line.dump() << "\n";
    figures.push_back(figures_of(plan, i, line));
  }
  manifest.close();
  if (!manifest) throw std::runtime_error(path.string() + ": cannot be written");
  sync_file(path);
  return figures;
}

Document dataset_document(const PopulationPlan& plan,
                          const DatasetFolder& folder,
                          const std::vector<SceneFigures>& figures,
                          OutputFolder& out) {
  const auto rows = shown_scenes(plan, folder, figures);
  write_png(out.stage(kSheet), contact_sheet(plan, rows));
  Document document{.title = "Data set " + plan.source, .name = "dataset"};
  document.add(Text{head_text(plan, figures)})
      .add(answer_of(plan, figures))
      .add(Picture{kSheet, "The first scenes of each stratum: the truth, and what was found."})
      .add(strata_table(plan, figures));
  add_shown(plan, folder, rows, out, document);
  Table refused = refusal_table(plan, figures);
  if (!refused.rows.empty()) document.add(Heading{"Refused"}).add(std::move(refused));
  return document;
}

Json dataset_json(const PopulationPlan& plan, const std::vector<SceneFigures>& figures) {
  return {{"plan", plan.source},
          {"plan_hash", plan.hash()},
          {"scenes", plan.scenes},
          {"refused", refused_in_all(figures)},
          {"bytes_per_scene", mean_bytes(figures)},
          {"strata", to_json(strata_table(plan, figures))}};
}

}  // namespace wobblebench::bench
