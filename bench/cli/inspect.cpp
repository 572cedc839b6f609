// What a recording holds, and what is damaged in it.
#include <filesystem>
#include <iostream>
#include <memory>

#include "base/user_error.h"
#include "bench/cli/inspection_report.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/output/output_folder.h"
#include "bench/pipeline/recording_sink.h"
#include "hw/link/link.h"
#include "hw/recording/recording.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  std::filesystem::path recording;
  std::filesystem::path salvage;  ///< where to copy what is undamaged; empty: nowhere
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

int inspect(const Arguments& arguments) {
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
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command =
      add_subcommand(app, "inspect", "What a recording holds, and what is wrong with it");
  add_required_path(command, "RECORDING", arguments->recording, "File that `record` wrote");
  add_path(command, "--salvage", arguments->salvage, "Copy what is undamaged to this new file");
  add_flag(command, "--json", arguments->json, "Print the report on stdout");
  return {&command, [arguments] { return inspect(*arguments); }};
}

}  // namespace wobblebench::bench
