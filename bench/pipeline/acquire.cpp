#include "bench/pipeline/acquire.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "base/file.h"
#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/pipeline/acquisitions.h"
#include "bench/pipeline/scene_warnings.h"
#include "bench/scene/subject_hash.h"

namespace wobblebench::bench {

namespace {

void check_balance(const hw::BoardAccount& account) {
  if (account.balanced()) return;
  throw std::logic_error("board account: emitted " + std::to_string(account.emitted) +
                         ", delivered " + std::to_string(account.delivered) + " + lost " +
                         std::to_string(account.lost.total()));
}

/// Over which linear envelopes are displayed: the scene's choice, or else the stream's.
double dynamic_range_db(const Scene& scene, const hw::DisplayScale& scale) {
  const bool is_chosen = scene.given.contains("simulation.dynamic_range_db");
  return scale.knows_range() && !is_chosen ? scale.dynamic_range_db
                                           : scene.simulation.dynamic_range_db;
}

/// Where the found surface depends on a dynamic range that nothing says.
void warn_of_range(const Scene& scene, Progress& progress) {
  const bool is_chosen = scene.given.contains("simulation.dynamic_range_db") ||
                         scene.given.contains("render.reconstruction.display_range_db");
  if (is_chosen || !render::has_stick_levels(scene.render)) return;
  progress.warn(
      "render.reconstruction.display_range_db: the dynamic range of the samples is not known and "
      "taken to be " +
      significant(scene.simulation.dynamic_range_db, 4) +
      " dB, by which render.ray_casting.below_tissue_db counts");
}

/// Without the options of the simulation that have the values with which the recording was made, as
/// the report beside it has them: they are not without effect.
Scene without_recorded(Scene scene, const BoardArguments& board) {
  const auto report = std::filesystem::path(board.link.value).replace_extension(".json");
  if (!std::filesystem::exists(report)) return scene;
  const auto json = nlohmann::ordered_json::parse(read_file(report), nullptr, false);
  if (!json.is_object() || !json.contains("scene")) return scene;
  const auto recorded = values_by_key(json["scene"]), here = values_by_key(resolved(scene));
  std::erase_if(scene.given, [&](const std::string& key) {
    if (!key.starts_with("simulation.")) return false;
    const auto then = recorded.find(key), now = here.find(key);
    return then != recorded.end() && now != here.end() && then->second == now->second;
  });
  return scene;
}

/// With the phantom of the scene.
ResolvedScene with_phantom(Scene scene, PhantomCache& cache, Progress& progress) {
  const auto phantom = progress.step("phantom", [&] { return cache.phantom(scene.phantom); });
  return resolve_scene(std::move(scene), phantom);
}

}  // namespace

BoardConnection::BoardConnection(const BoardArguments& arguments, const hw::BoardOptions& options)
    : arguments_(arguments), options_(options) {
  if (!is_simulated(arguments)) open();
}

void BoardConnection::open() {
  board_ = std::make_unique<hw::Board>(open_board_link(arguments_, {}), options_);
}

ResolvedScene BoardConnection::resolve(const Scene& given,
                                       PhantomCache& cache,
                                       Progress& progress) {
  if (is_simulated(arguments_)) {
    warn_of_scene(given, SampleSource::simulator, progress);
    return with_phantom(given, cache, progress);
  }
  progress.warn(acquisitions_warning(arguments_));
  const FirstConfiguration first = first_configuration(*board_, arguments_.text);
  configuration_ = first.configuration;
  before_configuration_ = first.before;
  Scene scene = with_display_scale(with_plan(given, configuration_->plan, name()),
                                   configuration_->display_scale);
  configuration_->plan = {scene.probe, configuration_->plan.acquisition()};
  if (!configuration_->display_scale.knows_range()) warn_of_range(scene, progress);
  if (configuration_->source != hw::StreamOrigin::simulated) {
    warn_of_scene(scene, SampleSource::unknown_subject, progress);
    return resolve_scene(std::move(scene), std::nullopt);
  }
  refuse_other_subject(scene, configuration_->subject, /*placed=*/false, name());
  warn_of_scene(without_recorded(scene, arguments_), SampleSource::recording_of_scene, progress);
  return with_phantom(std::move(scene), cache, progress);
}

sim::ProbeSimulator BoardConnection::simulator(const ResolvedScene& scene,
                                               const sim::TissueMapSource& maps,
                                               const sim::EchoStore& echoes) {
  sim::ProbeSimulator simulator(
      scene.subject().value(), scene.plan(), scene.simulation(), maps, echoes);
  simulated_ = SimulatedVolume{.effects = simulator.effects(),
                               .fidelity = simulator.fidelity(),
                               .map_ms = simulator.map_ms(),
                               .once_ms = simulator.once_ms()};
  return simulator;
}

StreamSource BoardConnection::connect(const ResolvedScene& scene,
                                      const sim::TissueMapSource& maps,
                                      const sim::EchoStore& echoes) {
  if (is_simulated(arguments_)) {
    sim::ProbeSimulator made = simulator(scene, maps, echoes);
    // The link computes its volumes from here on.
    connected_ = hw::HostClock::now();
    const auto sticks = [&] {
      return sim::stick_source(std::move(made), subject_hash(scene.options()));
    };
    board_ = std::make_unique<hw::Board>(open_board_link(arguments_, sticks, figures_), options_);
    return source(scene);
  }
  if (scene.subject() && configuration_) {
    refuse_other_subject(scene.options(), configuration_->subject, /*placed=*/true, name());
  }
  connected_ = hw::HostClock::now();
  // A device lost while its plan was read is opened once more: a recording can always be reopened,
  // a card may be back.
  if (board_->state() == hw::BoardState::lost) open();
  return source(scene);
}

StreamSource BoardConnection::source(const ResolvedScene& scene) {
  return {.board = *board_,
          .plan = scene.plan(),
          .name = arguments_.text,
          .configuration = configuration_,
          .before_configuration = before_configuration_,
          .dynamic_range_db = [options = scene.options()](const hw::DisplayScale& scale) {
            return dynamic_range_db(options, scale);
          }};
}

void BoardConnection::check_one_volume(const Scene& scene) const {
  // The first is meant of those that a report tells of.
  if (!is_simulated(arguments_) || scene.acquisition.volumes == 1 ||
      scene.reported.contains("acquisition.volumes")) {
    return;
  }
  throw UserError("acquisition.volumes = " + std::to_string(scene.acquisition.volumes) +
                  ": must be 1; this command renders one volume");
}

Acquisition BoardConnection::acquire(const ResolvedScene& scene, const sim::TissueMapSource& maps) {
  check_one_volume(scene.options());
  NoRenderer none;
  return acquire(connect(scene, maps), none, [](const ShownPicture&) {});
}

std::optional<SimulatedVolume> BoardConnection::simulated() const {
  std::optional<SimulatedVolume> simulated = simulated_;
  if (simulated) {
    simulated->volume_ms = figures_->volume_ms;
    simulated->late_ms = figures_->late_ms;
    simulated->packets_dropped = figures_->packets_dropped;
  }
  return simulated;
}

Acquisition BoardConnection::acquire(const StreamSource& source,
                                     StreamRenderer& renderer,
                                     const PictureSink& sink) {
  StreamResult result = stream_one_volume(source, renderer, sink);
  check_balance(result.account);
  KeptVolume& kept = *result.kept;
  const hw::HostTime delivered = result.records.back().last.acquired;
  // The volume may have been computed before the stream began.
  const double transport_ms =
      std::min(to_milliseconds(delivered - connected_) - figures_->volume_ms,
               to_milliseconds(delivered - result.begin));
  return {.volume = std::move(kept.volume),
          .samples = kept.samples,
          .account = result.reader.account,
          .read = result.account,
          .damage = result.damage,
          .link = result.link,
          .source = kept.configuration.source,
          .subject = kept.configuration.subject,
          .display_scale = kept.configuration.display_scale,
          .simulated = simulated(),
          .transport_ms = transport_ms,
          .off_plan_s = result.reader.off_plan_s,
          .ending = result.reader.ending,
          .board = arguments_.text,
          .knows_times = kept.configuration.knows_times};
}

}  // namespace wobblebench::bench
