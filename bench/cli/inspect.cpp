// What a recording holds, and what is damaged in it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "base/number_text.h"
#include "base/units.h"
#include "base/user_error.h"
#include "bench/cli/board_report.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/exchange/files/foreign_names.h"
#include "bench/exchange/input/foreign_scan.h"
#include "bench/output/output_folder.h"
#include "bench/output/report_parts.h"
#include "bench/pipeline/motor_warning.h"
#include "bench/pipeline/recording_sink.h"
#include "bench/results/check.h"
#include "hw/link/link.h"
#include "hw/recording/recording.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

/// Most damaged regions, gaps, incomplete volumes, acquisitions and jumps of the clock that the
/// summary lists.
constexpr std::size_t kMostListed = 10;

std::string count(std::uint64_t number, const std::string& what) {
  return std::to_string(number) + " " + what + (number == 1 ? "" : "s");
}

std::string unreadable_text(const hw::RecordingContents& contents) {
  const hw::UnreadablePlace& place = contents.unreadable.value();
  return "from byte " + std::to_string(place.offset) + " on, " +
         count(contents.bytes - place.offset, "byte") + ": " + place.reason;
}

Json unreadable_json(const hw::RecordingContents& contents) {
  if (!contents.unreadable) return nullptr;
  const auto& [offset, reason] = *contents.unreadable;
  return {{"offset", offset}, {"bytes", contents.bytes - offset}, {"reason", reason}};
}

std::vector<Check> checks_of(const hw::RecordingContents& contents) {
  std::vector<Check> checks;
  const auto add = [&](const std::string& name, bool held, const std::string& failure) {
    checks.push_back({.group = "recording", .name = name, .failure = held ? "" : failure});
  };
  const bool readable = !contents.unreadable;
  add("recording.readable", readable, readable ? "" : unreadable_text(contents));
  add("recording.bytes",
      contents.damage.regions == 0,
      count(contents.damage.bytes_skipped, "byte") + " belong to no packet, in " +
          count(contents.damage.regions, "place"));
  add("recording.configuration", contents.configuration.has_value(), "has no configuration");
  add("recording.consistent",
      contents.contradictions == 0,
      count(contents.contradictions, "packet") + " contradict the configuration");
  return checks;
}

/// Null where the recording does not say what it is of.
Json subject_json(const hw::SubjectHash& subject) {
  if (!subject.stated()) return nullptr;
  return {
      {"phantom", subject.phantom}, {"placement", subject.placement}, {"motion", subject.motion}};
}

Json acquisitions_json(const hw::RecordingContents& contents) {
  Json acquisitions = Json::array();
  for (const hw::RecordedAcquisition& one : contents.acquisitions) {
    acquisitions.push_back(
        {{"number", acquisitions.size() + 1},
         {"offset", one.offset},
         {"first_volume", one.volume},
         {"volumes", one.volumes},
         {"delivered", one.sticks},
         {"acquisition", acquisition_json(one.configuration.plan, one.configuration.knows_times)},
         {"motor_angles", motor_json(one.motor)},
         {"depth_mm", one.configuration.plan.acquisition().depth_m / kMillimetre},
         {"samples_from", hw::to_string(one.configuration.source)},
         {"subject", subject_json(one.configuration.subject)},
         {"display_scale", display_scale_json(one.configuration.display_scale)}});
  }
  return acquisitions;
}

Json recording_json(const std::filesystem::path& path, const hw::RecordingContents& contents) {
  Json places = Json::array(), gaps = Json::array(), volumes = Json::array();
  Json jumps = Json::array();
  for (const auto& place : contents.damaged_regions) {
    places.push_back({{"offset", place.offset}, {"bytes", place.bytes}});
  }
  for (const auto& gap : contents.gaps) {
    gaps.push_back({{"first_sequence", gap.first_sequence},
                    {"count", gap.count},
                    {"cause", hw::to_string(gap.cause)}});
  }
  for (const auto& volume : contents.volumes) {
    volumes.push_back({{"index", volume.index},
                       {"acquisition", volume.acquisition},
                       {"sticks", volume.sticks},
                       {"closed", volume.closed}});
  }
  for (const auto& jump : contents.time_jumps) {
    jumps.push_back(
        {{"offset", jump.offset}, {"sequence", jump.sequence}, {"later_s", jump.later_s}});
  }
  return {{"file", path.string()},
          {"bytes", contents.bytes},
          {"damaged", contents.damaged()},
          {"complete", contents.complete()},
          {"packets",
           {{"configuration", contents.configurations},
            {"stick", contents.sticks},
            {"volume_end", contents.volume_ends},
            {"unknown", contents.other_packets}}},
          {"acquisitions", acquisitions_json(contents)},
          {"acquisition_count", contents.acquisition_count},
          {"before_configuration", contents.unconfigured},
          {"contradictions", contents.contradictions},
          {"unreadable", unreadable_json(contents)},
          {"damage", places},
          {"gaps", gaps},
          {"volumes", volumes},
          {"time_jumps", jumps},
          {"time_jump_count", contents.time_jump_count}};
}

void write_plan(std::ostream& text, const hw::RecordedAcquisition& of) {
  const hw::Configuration& configuration = of.configuration;
  const auto& plan = configuration.plan.acquisition();
  text << "plan        " << plan.frames_per_volume << " frames of " << plan.sticks_per_frame
       << " sticks of " << plan.samples_per_stick << " samples, depth "
       << plan.depth_m / kMillimetre << " mm, "
       << (configuration.knows_times
               ? significant(1 / configuration.plan.stick_period_s(), 4) + " lines/s"
               : "times not known")
       << "; samples " << hw::to_string(configuration.source) << "\nscale       "
       << display_scale_text(configuration.display_scale) << "\n";
  const std::string motor = motor_text(of.motor, configuration.plan);
  if (!motor.empty()) text << "motor       " << motor << "\n";
}

/// One, as almost always, without its number.
void write_acquisitions(std::ostream& text, const hw::RecordingContents& contents) {
  const auto& acquisitions = contents.acquisitions;
  if (contents.acquisition_count == 1) return write_plan(text, acquisitions.front());
  if (acquisitions.empty()) return;
  text << "acquisitions " << contents.acquisition_count
       << ", one after the other; --board file=RECORDING,acquisition=N takes one\n";
  for (std::size_t i = 0; i < std::min(kMostListed, acquisitions.size()); ++i) {
    const hw::RecordedAcquisition& one = acquisitions[i];
    text << "acquisition " << i + 1 << ", from byte " << one.offset << ": "
         << count(one.volumes, "volume") << " from volume " << one.volume << " on, "
         << count(one.sticks, "stick") << "\n";
    write_plan(text, one);
  }
}

void write_volumes(std::ostream& text, const hw::RecordingContents& contents) {
  if (!contents.configuration) return;
  std::size_t shown = 0;
  std::uint64_t whole = 0;
  std::ostringstream partial;
  for (const auto& volume : contents.volumes) {
    if (volume.whole()) {
      ++whole;
    } else if (shown++ < kMostListed) {
      partial << "            volume " << volume.index;
      if (contents.acquisition_count > 1) partial << " of acquisition " << volume.acquisition;
      partial << ": " << volume.sticks << " of ";
      if (volume.acquisition == 0) {
        partial << "an unknown number of sticks: before any configuration\n";
      } else {
        partial << volume.expected << " sticks" << (volume.closed ? "" : ", not closed") << "\n";
      }
    }
  }
  text << "volumes     " << contents.volumes.size() << ", of which " << whole << " whole\n"
       << partial.str();
}

void write_time_jumps(std::ostream& text, const hw::RecordingContents& contents) {
  if (contents.time_jump_count == 0) return;
  text << "times       leave the plan in " << count(contents.time_jump_count, "place")
       << "; playback at pace=realtime goes by the plan\n";
  for (std::size_t i = 0; i < std::min(kMostListed, contents.time_jumps.size()); ++i) {
    const hw::TimeJump& jump = contents.time_jumps[i];
    text << "            at byte " << jump.offset << ", stick " << jump.sequence << ": "
         << significant(std::abs(jump.later_s), 6) << " s "
         << (jump.later_s > 0 ? "later" : "earlier") << "\n";
  }
}

void write_faults(std::ostream& text, const hw::RecordingContents& contents) {
  text << "damage      " << count(contents.damage.regions, "place") << ", "
       << count(contents.damage.bytes_skipped, "byte") << "\n";
  for (std::size_t i = 0; i < std::min(kMostListed, contents.damaged_regions.size()); ++i) {
    text << "            at byte " << contents.damaged_regions[i].offset << ": "
         << count(contents.damaged_regions[i].bytes, "byte") << "\n";
  }
  if (contents.unreadable) text << "unreadable  " << unreadable_text(contents) << "\n";
  text << "missing     " << count(contents.account.lost.total(), "stick") << "\n";
  for (std::size_t i = 0; i < std::min(kMostListed, contents.gaps.size()); ++i) {
    const hw::Gap& gap = contents.gaps[i];
    text << "            from stick " << gap.first_sequence << ": " << gap.count << " ("
         << hw::to_string(gap.cause) << ")\n";
  }
}

/// The text of report.json.
std::string inspection_report(const std::filesystem::path& path,
                              const hw::RecordingContents& contents) {
  Provenance provenance = provenance_of_this_machine();
  provenance.board = "recording";
  Json report = {{"schema", kReportSchema},
                 {"command", "inspect"},
                 {"provenance", to_json(provenance)},
                 {"board", account_json(contents.account)},
                 {"recording", recording_json(path, contents)},
                 {"checks", to_json(checks_of(contents))},
                 {"warnings", Json::array()}};
  if (const auto& configuration = contents.configuration) {
    report["acquisition"] = acquisition_json(configuration->plan, configuration->knows_times);
    report["acquisition"]["motor_angles"] = motor_json(contents.acquisitions.front().motor);
    report["board"]["samples_from"] = hw::to_string(configuration->source);
    report["recording"]["subject"] = subject_json(configuration->subject);
    report["recording"]["display_scale"] = display_scale_json(configuration->display_scale);
  }
  return report_text(report);
}

/// A few lines for a terminal.
std::string inspection_summary(const std::filesystem::path& path,
                               const hw::RecordingContents& contents) {
  std::ostringstream text;
  text << "file        " << path.string() << ", " << std::setprecision(4)
       << static_cast<double>(contents.bytes) / 1e6 << " MB\n";
  write_acquisitions(text, contents);
  text << "packets     " << contents.configurations << " configurations, " << contents.sticks
       << " sticks, " << contents.volume_ends << " volume ends\n";
  write_volumes(text, contents);
  write_faults(text, contents);
  write_time_jumps(text, contents);
  text << "verdict     "
       << (contents.damaged()    ? "damaged"
           : contents.complete() ? "undamaged and complete"
                                 : "undamaged; sticks are missing that never came")
       << "\n";
  return text.str();
}

struct InspectArguments {
  std::filesystem::path recording;
  std::filesystem::path geometry;  ///< of a file of another program
  std::filesystem::path salvage;   ///< where to copy what is undamaged; empty: nowhere
  bool json = false;
};

void salvage(const std::filesystem::path& from, const std::filesystem::path& to) {
  const auto folder = to.has_parent_path() ? to.parent_path() : ".";
  OutputFolder out(folder, "--salvage in");
  if (std::filesystem::exists(std::filesystem::symlink_status(to))) {
    throw UserError("--salvage = " + to.string() + ": exists; must be a new file");
  }
  RecordingSink sink(out.stage(to.filename()));
  hw::salvage_recording(from, [&](auto bytes) { sink.write(bytes); });
  sink.finish(sink.bytes());
  const hw::RecordingContents contents = hw::inspect_recording(sink.path());
  if (contents.damaged()) throw std::logic_error(to.string() + ": salvaged, and still damaged");
  out.commit();
  std::cerr << "salvaged    " << contents.account.delivered << " sticks to " << to.string() << "\n";
}

/// What a file of another program holds, as the recording that it is taken for.
int inspect_foreign(const InspectArguments& arguments) {
  if (!arguments.salvage.empty()) {
    throw UserError("--salvage: acts with a recording; " + arguments.recording.string() +
                    " is a file of another program");
  }
  const ForeignScan scan = open_foreign_scan(arguments.recording, arguments.geometry);
  const FileDescriptor file = recorded(scan);
  const auto contents = hw::inspect_recording(descriptor_path(file));
  std::cout << (arguments.json ? inspection_report(arguments.recording, contents)
                               : inspection_summary(arguments.recording, contents) + scan.summary);
  return kDone;
}

int inspect(const InspectArguments& arguments) {
  if (foreign_format(arguments.recording) != ForeignFormat::none) {
    return inspect_foreign(arguments);
  }
  if (!arguments.geometry.empty()) {
    throw UserError(std::string("--geometry: acts with a file of another program (") +
                    kForeignNames + "); " + arguments.recording.string() + " is none");
  }
  try {
    const auto contents = hw::inspect_recording(arguments.recording);
    if (!arguments.salvage.empty()) salvage(arguments.recording, arguments.salvage);
    std::cout << (arguments.json ? inspection_report(arguments.recording, contents)
                                 : inspection_summary(arguments.recording, contents));
    return contents.damaged() ? 1 : 0;
  } catch (const hw::LinkOpenError& error) {
    throw UserError(error.what());
  }
}

}  // namespace

Command add_inspect_command(CLI::App& app) {
  const auto arguments = std::make_shared<InspectArguments>();
  CLI::App& command =
      add_subcommand(app, "inspect", "What a recording holds, and what is wrong with it");
  add_required_path(
      command,
      "RECORDING",
      arguments->recording,
      std::string("File that `record` wrote, or another program's: ") + kForeignNames);
  add_path(command,
           "--geometry",
           arguments->geometry,
           "TOML file that says how the voxels of another program's file were scanned");
  add_path(command, "--salvage", arguments->salvage, "Copy what is undamaged to this new file");
  add_flag(command, "--json", arguments->json, "Print the report on stdout");
  return {&command, [arguments] { return inspect(*arguments); }};
}

}  // namespace wobblebench::bench
