#include "bench/tables.h"

#include <algorithm>
#include <iomanip>
#include <map>
#include <memory>
#include <sstream>
#include <tuple>

#include "bench/acquire.h"
#include "bench/user_error.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

TableRow varied(const std::string& setting, double paper_ms, int TableRow::*field, int value) {
  TableRow row{setting, paper_ms};
  row.*field = value;
  return row;
}

/// What tells two rows apart as measurements; equal ones are measured once.
auto key_of(const TableRow& row) {
  return std::tuple(row.frames, row.side, row.kernel_3d, row.kernel_2d);
}
using RowKey = decltype(key_of(TableRow{}));

render::RenderOptions options_of(const TableRow& row, const Scene& scene, int divisor) {
  render::RenderOptions options = scene.render;
  options.scan_conversion.slice_size = row.side / divisor;
  options.ray_casting.image_size = row.side / divisor;
  options.ray_casting.steps = row.side / divisor;
  options.ray_casting.kernel_3d = row.kernel_3d;
  options.ray_casting.mode = render::RenderMode::surface;
  options.shading.depth_filter_size = row.kernel_2d;
  options.smoothing.filter_size = row.kernel_2d;
  return options;
}

/// One setting under measurement: its renderer lives through all repeats.
struct Subject {
  const hw::PolarVolume* volume = nullptr;
  std::unique_ptr<render::Renderer> renderer;
  std::vector<std::vector<double>> pass_ms;  ///< [pass][repeat]
  std::vector<std::string> pass_names;

  void measure(bool counted) {
    for (int f = 0; f < static_cast<int>(volume->frames().size()); ++f) {
      renderer->add_frame(f, volume->frame(f));
    }
    const auto picture = renderer->render();
    if (!counted) return;
    pass_ms.resize(picture.passes.size());
    pass_names.clear();
    for (std::size_t i = 0; i < picture.passes.size(); ++i) {
      pass_ms[i].push_back(picture.passes[i].ms);
      pass_names.push_back(picture.passes[i].name);
    }
  }

  MeasuredRow result(const TableRow& row) const {
    MeasuredRow measured{row, {}, {}, 0, 0};
    std::vector<double> frame_ms(pass_ms.front().size(), 0.0);
    for (const auto& pass : pass_ms) {
      measured.pass_ms.push_back(spread_of(pass).median);
      for (std::size_t i = 0; i < pass.size(); ++i) frame_ms[i] += pass[i];
    }
    measured.frame_ms = spread_of(frame_ms);
    return measured;
  }
};

using Volumes = std::map<int, hw::PolarVolume>;

/// One volume for each number of frames; what they are goes into `results`.
Volumes acquire_volumes(const Scene& scene,
                        const phantoms::Phantom& phantom,
                        TableResults& results) {
  Volumes volumes;
  for (const Table& table : paper_tables()) {
    for (const TableRow& row : table.rows) {
      if (volumes.contains(row.frames)) continue;
      Scene varied_scene = scene;
      varied_scene.acquisition.frames_per_volume = row.frames;
      Acquisition acquisition = acquire({}, varied_scene, phantom);
      results.board = acquisition.provenance;
      results.effects = acquisition.effects;
      volumes.emplace(row.frames, std::move(acquisition.volume));
    }
  }
  return volumes;
}

std::map<RowKey, Subject> make_subjects(const Scene& scene,
                                        const Volumes& volumes,
                                        render::GlContext& context,
                                        int divisor) {
  std::map<RowKey, Subject> subjects;
  for (const Table& table : paper_tables()) {
    for (const TableRow& row : table.rows) {
      Subject& subject = subjects[key_of(row)];
      if (subject.renderer) continue;
      subject.volume = &volumes.at(row.frames);
      subject.renderer = std::make_unique<render::Renderer>(
          context, subject.volume->plan(), options_of(row, scene, divisor));
    }
  }
  return subjects;
}

MeasuredRow against(const MeasuredRow& reference, MeasuredRow row) {
  row.ratio = row.frame_ms.median / reference.frame_ms.median;
  row.paper_ratio = row.row.paper_ms / reference.row.paper_ms;
  return row;
}

}  // namespace

TableRow reference_row() {
  return {"37 frames, 512^3, 3x3x3, 9x9", 54.6};
}

std::vector<Table> paper_tables() {
  return {
      {"I",
       "frames per volume",
       {varied("27", 53.7, &TableRow::frames, 27),
        varied("31", 54.0, &TableRow::frames, 31),
        varied("35", 54.6, &TableRow::frames, 35),
        varied("37", 54.6, &TableRow::frames, 37)}},
      {"II",
       "volume size",
       {varied("512^3", 54.6, &TableRow::side, 512),
        varied("384^3", 35.0, &TableRow::side, 384),
        varied("256^3", 15.8, &TableRow::side, 256),
        varied("128^3", 13.2, &TableRow::side, 128)}},
      {"III",
       "3D filter kernel",
       {varied("none", 21.5, &TableRow::kernel_3d, 1),
        varied("3x3x3", 54.6, &TableRow::kernel_3d, 3),
        varied("5x5x5", 187, &TableRow::kernel_3d, 5)}},
      {"IV",
       "2D homogeneous filter",
       {varied("3x3", 54.3, &TableRow::kernel_2d, 3),
        varied("5x5", 54.9, &TableRow::kernel_2d, 5),
        varied("7x7", 55.5, &TableRow::kernel_2d, 7),
        varied("11x11", 56.8, &TableRow::kernel_2d, 11)}},
  };
}

void take_reference_settings(Scene& scene, const TableRun& run) {
  for (const char* key : {"acquisition.frames_per_volume",
                          "render.scan_conversion.slice_size",
                          "render.ray_casting.image_size",
                          "render.ray_casting.steps",
                          "render.ray_casting.kernel_3d",
                          "render.ray_casting.mode",
                          "render.shading.depth_filter_size",
                          "render.smoothing.filter_size"}) {
    if (scene.given.contains(key)) {
      throw UserError(std::string(key) + ": is set by the tables themselves; leave it out");
    }
  }
  scene.acquisition.frames_per_volume = reference_row().frames;
  scene.render = options_of(reference_row(), scene, run.divisor);
}

TableResults measure_tables(const Scene& scene,
                            const phantoms::Phantom& phantom,
                            render::GlContext& context,
                            const TableRun& run) {
  TableResults results;
  const Volumes volumes = acquire_volumes(scene, phantom, results);
  auto subjects = make_subjects(scene, volumes, context, run.divisor);
  for (int repeat = -1; repeat < run.repeats; ++repeat) {
    for (auto& [key, subject] : subjects) subject.measure(repeat >= 0);
  }
  const Subject& reference = subjects.at(key_of(reference_row()));
  results.pass_names = reference.pass_names;
  results.reference = reference.result(reference_row());
  results.reference = against(results.reference, results.reference);
  for (const Table& table : paper_tables()) {
    MeasuredTable measured{table.id, table.title, {}};
    for (const TableRow& row : table.rows) {
      measured.rows.push_back(against(results.reference, subjects.at(key_of(row)).result(row)));
    }
    results.tables.push_back(std::move(measured));
  }
  return results;
}

std::string describe_run(const TableRun& run) {
  std::ostringstream text;
  if (run.divisor == 1) {
    text << "The paper's sizes.";
  } else {
    text << "REDUCED: slice, image and ray steps are 1/" << run.divisor
         << " of the paper's in each direction (512^3 is run as " << 512 / run.divisor
         << "^3); frames, sticks, samples and kernels are the paper's. --full runs the paper's "
            "sizes.";
  }
  text << " Each setting: median of " << run.repeats
       << " after one uncounted, all settings in turn in each repeat; a setting that several tables"
          " share is measured once. Time: four passes, all frames, upload included.";
  return text.str();
}

std::string to_markdown(const TableResults& results, const TableRun& run) {
  std::ostringstream text;
  text << std::fixed << describe_run(run) << "\n";
  for (const MeasuredTable& table : results.tables) {
    text << "\n### Table " << table.id << ": " << table.title << "\n\n"
         << "| setting | paper ms | plain ms | min - max | paper ratio | plain ratio |";
    for (const auto& pass : results.pass_names) text << " " << pass << " ms |";
    text << "\n| --- | ---: | ---: | ---: | ---: | ---: |";
    for (std::size_t i = 0; i < results.pass_names.size(); ++i) text << " ---: |";
    text << "\n";
    for (const MeasuredRow& row : table.rows) {
      text << "| " << row.row.setting << std::setprecision(1) << " | " << row.row.paper_ms << " | "
           << row.frame_ms.median << " | " << row.frame_ms.min << " - " << row.frame_ms.max << " | "
           << std::setprecision(2) << row.paper_ratio << " | " << row.ratio << " |"
           << std::setprecision(1);
      for (double ms : row.pass_ms) text << " " << ms << " |";
      text << "\n";
    }
  }
  return text.str();
}

std::string to_csv(const TableResults& results, const TableRun& run) {
  std::ostringstream text;
  text << "table,setting,side,frames,kernel_3d,kernel_2d,paper_ms,plain_ms,plain_min_ms,plain_max_"
          "ms,"
          "paper_ratio,plain_ratio";
  for (const auto& pass : results.pass_names) text << "," << pass << "_ms";
  text << "\n";
  for (const MeasuredTable& table : results.tables) {
    for (const MeasuredRow& row : table.rows) {
      text << table.id << "," << row.row.setting << "," << row.row.side / run.divisor << ","
           << row.row.frames << "," << row.row.kernel_3d << "," << row.row.kernel_2d << ","
           << row.row.paper_ms << "," << row.frame_ms.median << "," << row.frame_ms.min << ","
           << row.frame_ms.max << "," << row.paper_ratio << "," << row.ratio;
      for (double ms : row.pass_ms) text << "," << ms;
      text << "\n";
    }
  }
  return text.str();
}

}  // namespace wobblebench::bench
