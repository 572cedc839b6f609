// Writes what a board sends to a file.
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <stdexcept>

#include "bench/cli/commands.h"
#include "bench/cli/user_error.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/recording_sink.h"
#include "bench/pipeline/simulated_sticks.h"
#include "bench/report/board_report.h"
#include "bench/report/output_folder.h"
#include "bench/report/report.h"
#include "bench/scene/adopt_plan.h"
#include "hw/recording/recorder.h"

namespace wobblebench::bench {

namespace {

constexpr const char* kFileName = "recording.wbst";

volatile std::sig_atomic_t asked_to_end = 0;

/// The first signal ends the recording in order; a second one ends the program.
void on_signal(int signal) {
  asked_to_end = 1;
  std::signal(signal, SIG_DFL);
}

const char* to_string(hw::RecordingEnd end) {
  switch (end) {
    case hw::RecordingEnd::volumes:
      return "as many volumes as asked for";
    case hw::RecordingEnd::end_of_stream:
      return "the stream is over";
    case hw::RecordingEnd::lost:
      return "the device is lost";
    case hw::RecordingEnd::stop_requested:
      return "interrupted";
  }
  return "unknown";
}

/// What a terminal shows while a recording grows; a log gets a line every few seconds.
class RecordingLine {
 public:
  void show(const hw::RecordingProgress& progress) {
    const bool terminal = ::isatty(STDERR_FILENO) == 1;
    const auto now = std::chrono::steady_clock::now();
    if (!terminal && now < next_) return;
    next_ = now + std::chrono::seconds(5);
    std::fprintf(stderr,
                 "%llu volumes, %.1f MB, %llu sticks lost%s",
                 static_cast<unsigned long long>(progress.volumes),
                 static_cast<double>(progress.bytes) / 1e6,
                 static_cast<unsigned long long>(progress.account.lost.total()),
                 terminal ? "   \r" : "\n");
  }

 private:
  std::chrono::steady_clock::time_point next_{};
};

/// Records to the sink; on a failure of the disk says what is safe.
hw::RecordingEnd record(hw::Recorder& recorder, RecordingSink& sink) {
  RecordingLine line;
  try {
    return recorder.run([] { return asked_to_end != 0; },
                        [&](const hw::RecordingProgress& progress) {
                          sink.sync();
                          line.show(progress);
                        });
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string(error.what()) + "; it holds " +
                             std::to_string(recorder.progress().volumes) +
                             " whole volumes, which `inspect --salvage` copies");
  }
}

Json to_report(const hw::RecordingProgress& progress,
               hw::RecordingEnd end,
               const hw::LinkCapabilities& link,
               Scene& scene) {
  if (progress.configuration) {
    scene.acquisition = progress.configuration->plan.acquisition();
    static_cast<hw::ProbeOptions&>(scene.probe) = progress.configuration->plan.probe();
  }
  Provenance provenance = provenance_of_this_machine();
  provenance.board = hw::to_string(link.origin);
  Json report = report_head("record", provenance, scene);
  report["acquisition"] = acquisition_json(scene.plan());
  report["board"] = account_json(progress.account);
  report["board"]["damage"] = {{"places", progress.damage.regions},
                               {"bytes_skipped", progress.damage.bytes_skipped}};
  report["board"]["link"] = link_json(link);
  report["recording"] = {{"file", kFileName},
                         {"bytes", progress.bytes},
                         {"volumes", progress.volumes},
                         {"ended_because", to_string(end)}};
  return report;
}

}  // namespace

int record_command(const CommandArguments& arguments) {
  Scene scene = load_scene(arguments.scene, arguments.settings);
  const BoardArguments board = parse_board(arguments.board);
  if (arguments.volumes > 0 && !scene.given.contains("acquisition.volumes")) {
    scene.acquisition.volumes = arguments.volumes;
  }
  OutputFolder out(arguments.out);
  const auto link =
      open_board_link(board, is_simulated(board) ? simulated_sticks(scene) : MakeSticks{});
  RecordingSink sink(out.directory() / kFileName);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  hw::Recorder recorder(
      *link, [&](auto bytes) { sink.write(bytes); }, {.volumes = arguments.volumes});
  const hw::RecordingEnd end = record(recorder, sink);
  const hw::RecordingProgress& progress = recorder.progress();
  if (!progress.account.balanced()) throw std::logic_error("recording: account is not balanced");
  sink.finish();

  const Json report = to_report(progress, end, link->capabilities(), scene);
  out.write_text("report.json", report.dump(2) + "\n");
  out.commit();
  if (arguments.json) {
    std::cout << report.dump(2) << "\n";
  } else {
    std::cout << "recorded    " << progress.volumes << " volumes, " << progress.account.delivered
              << " sticks, " << static_cast<double>(progress.bytes) / 1e6 << " MB; "
              << progress.account.lost.total() << " sticks lost; " << to_string(end) << "\n"
              << "recording   " << sink.path().string() << "\n";
  }
  if (end != hw::RecordingEnd::lost) return 0;
  std::cerr << "wobblebench: --board = " << arguments.board << ": " << link->loss() << "\n";
  return 1;
}

}  // namespace wobblebench::bench
