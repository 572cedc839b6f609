#include "bench/studies/tables/tables_program.h"

#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/software_renderer.h"
#include "bench/output/report_parts.h"
#include "bench/pipeline/acquisitions.h"
#include "bench/pipeline/motor_warning.h"
#include "bench/pipeline/outside_link.h"
#include "bench/studies/tables/compared_pictures.h"
#include "bench/studies/tables/measure.h"
#include "bench/studies/tables/stage_times.h"
#include "bench/studies/tables/tables_report.h"
#include "bench/studies/tables/volumes.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  std::string board;
  std::string gl = "osmesa";
  OutputArguments output;
  TableArguments tables;
  bool gpu = false;
  bool pictures = false;
  std::filesystem::path against;
};

constexpr const char* kPicturesName = "pictures.npy";

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--board",
                 arguments.board,
                 "Where sticks come from: file=RECORDING or xdma=DEVICE, then ,key=value …")
      ->required();
  add_gl_option(app, arguments.gl);
  add_flag(app, "--gpu", arguments.gpu, "Refuse a context that renders on the CPU");
  add_table_options(app, arguments.tables);
  add_flag(app,
           "--pictures",
           arguments.pictures,
           "No tables: pictures of this context, for --against of another");
  add_path(app,
           "--against",
           arguments.against,
           "Folder of a run with --pictures: compare this context's pictures with them");
  app.get_option("--against")->type_name("FOLDER")->excludes("--pictures");
  add_output_options(app, arguments.output);
}

/// Pictures of another context, and what its report says of them.
struct OtherPictures {
  std::vector<ComparedPicture> pictures;
  std::string renderer;
  std::string commit;
  std::uint32_t samples_crc = 0;
};

/// Throws UserError.
OtherPictures read_other(const std::filesystem::path& folder) {
  const std::string option = "--against = " + folder.string() + ": ";
  OtherPictures other;
  try {
    other.pictures = read_compared(read_file(folder / kPicturesName));
    const auto report = nlohmann::json::parse(read_file(folder / "report.json"));
    other.renderer = report.at("provenance").at("gl_renderer");
    other.commit = report.at("provenance").at("commit");
    other.samples_crc = report.at("samples_crc");
  } catch (const std::invalid_argument& error) {
    throw UserError(option + kPicturesName + " " + error.what());
  } catch (const std::exception& error) {
    throw UserError(option + "must be the folder of a run with --pictures: " + error.what());
  }
  return other;
}

const hw::PolarVolume& reference_volume(const TableVolumes& volumes) {
  return volumes.by_frames.at(reference_row().frames);
}

/// Refuses pictures of another recording or size, before anything is measured.
void check_other(const OtherPictures& other,
                 const Arguments& arguments,
                 const TableVolumes& volumes) {
  const std::string option = "--against = " + arguments.against.string() + ": ";
  if (other.samples_crc != samples_crc(reference_volume(volumes))) {
    throw UserError(option + "shows another volume than --board " + arguments.board);
  }
  const int side = paper_settings(arguments.tables.run()).ray_casting.image_size;
  const auto& theirs = other.pictures.front().cast_m;
  if (theirs.width == side && theirs.height == side) return;
  throw UserError(option + "has pictures of " + std::to_string(theirs.width) + " x " +
                  std::to_string(theirs.height) + " pixels; must be " + std::to_string(side) +
                  " x " + std::to_string(side) + ", as --full and --divisor say here");
}

PicturesAgainst compare_with(const OtherPictures& other,
                             const Arguments& arguments,
                             const TableVolumes& volumes,
                             render::GlContext& context) {
  const auto here = render_compared(reference_volume(volumes), context, arguments.tables.run());
  return {other.renderer + ", commit " + other.commit, compare_pictures(here, other.pictures)};
}

void refuse_cpu(const render::GlContext& context, const Arguments& arguments) {
  const std::string renderer = context.renderer_string();
  if (!arguments.gpu || !is_software(renderer)) return;
  throw std::runtime_error("--gpu: --gl " + arguments.gl + " renders on the CPU: " + renderer);
}

nlohmann::ordered_json report_of(const Provenance& provenance,
                                 const TableVolumes& volumes,
                                 const TableResults& results,
                                 const TableRun& run,
                                 const Document& document) {
  nlohmann::ordered_json report = {{"schema", kReportSchema},
                                   {"command", "tables"},
                                   {"provenance", to_json(provenance)},
                                   {"effects", volumes.effects}};
  report["acquisition"] =
      acquisition_json(volumes.by_frames.at(reference_row().frames).plan(), volumes.knows_times);
  report["acquisition"]["motor_angles"] = motor_json(volumes.motor);
  add_tables(report, results, run, volumes.note, document);
  return report;
}

/// Whether the rounding of filters explains the pictures.
Check pictures_check(const PicturesAgainst& against) {
  const std::string failure = "more than " + fixed(100 * kMostUnexplained, 1) +
                              " % of a picture's pixels are not explained by the rounding of "
                              "filters";
  return {.group = "tables",
          .name = "pictures",
          .failure = against.all_explained() ? "" : failure,
          .asked = "--against"};
}

CommandResult measure(const Arguments& arguments,
                      const TableVolumes& volumes,
                      const std::optional<OtherPictures>& other,
                      render::GlContext& context,
                      Progress& progress) {
  const TableRun run = arguments.tables.run();
  const TableResults results = progress.step("tables", [&](const PartDone& done) {
    return measure_tables(volumes, {}, context, run, done);
  });
  const Provenance provenance = provenance_of(context, volumes);
  CommandResult result{.document = tables_document(results, run, volumes.note, provenance)};
  std::optional<PicturesAgainst> against;
  if (other) {
    against = compare_with(*other, arguments, volumes, context);
    add_agreement(*against, result.document);
    add_check(pictures_check(*against), result);
  }
  auto report = report_of(provenance, volumes, results, run, result.document);
  if (against) report["against"] = against->other;
  result.report = report_text(report);
  return result;
}

CommandResult make_pictures(const Arguments& arguments,
                            const TableVolumes& volumes,
                            render::GlContext& context,
                            OutputFolder& out) {
  const auto pictures = render_compared(reference_volume(volumes), context, arguments.tables.run());
  out.write_text(kPicturesName, compared_bytes(pictures));
  const Provenance provenance = provenance_of(context, volumes);
  const nlohmann::ordered_json report = {{"schema", kReportSchema},
                                         {"command", "pictures"},
                                         {"provenance", to_json(provenance)},
                                         {"samples_crc", samples_crc(reference_volume(volumes))}};
  return {.report = report_text(report),
          .summary = "pictures    " + (out.directory() / kPicturesName).string() + "\n"};
}

int measure_recording(const Arguments& arguments) {
  const BoardArguments board = parse_outside_board(arguments.board);
  std::optional<OtherPictures> other;
  if (!arguments.against.empty()) other = read_other(arguments.against);
  auto link = open_outside_link(board);
  const auto context = render::make_context(arguments.gl);
  refuse_cpu(*context, arguments);
  const auto work = [&](OutputFolder& out, Progress& progress) {
    progress.warn(acquisitions_warning(board));
    warn_of_software(*context, arguments.gl, progress);
    const TableVolumes volumes =
        progress.step("volume", [&] { return recorded_volumes(std::move(link), board.text); });
    warn_of_motor(volumes.motor, reference_volume(volumes).plan(), progress);
    if (other) check_other(*other, arguments, volumes);
    if (arguments.pictures) return make_pictures(arguments, volumes, *context, out);
    return measure(arguments, volumes, other, *context, progress);
  };
  return run_in_folder(arguments.output, {{"volume", 1}, {"tables", 60}}, work);
}

}  // namespace

TableRun TableArguments::run() const {
  const int size = full ? 1 : divisor;
  // A picture of the plain pipeline takes seconds at the paper's sizes, on a CPU.
  const int plain = plain_repeats > 0 ? plain_repeats : size == 1 ? 1 : repeats;
  return {.divisor = size, .repeats = repeats, .plain_repeats = plain};
}

void add_table_options(CLI::App& command, TableArguments& arguments) {
  add_flag(command, "--full", arguments.full, "The paper's sizes; otherwise half of them a side");
  add_integer(command,
              "--divisor",
              arguments.divisor,
              "Sides are the paper's over this: 1, 2, 4 or 8",
              1,
              8)
      .check(CLI::IsMember({"1", "2", "4", "8"}))
      ->excludes("--full");
  add_repeats_option(command, arguments.repeats);
  add_integer(command,
              "--plain-repeats",
              arguments.plain_repeats,
              "Likewise, plain pipeline; default: 1 with the paper's sizes, else as --repeats",
              1,
              100)
      .default_str("");
}

Program tables_program() {
  return {"wobblebench-tables",
          "wobblebench-tables: Tables I to IV of the paper, measured on a recording",
          [](CLI::App& app) -> std::vector<Command> {
            const auto arguments = std::make_shared<Arguments>();
            add_options(app, *arguments);
            return {{&app, [arguments] { return measure_recording(*arguments); }}};
          }};
}

}  // namespace wobblebench::bench
