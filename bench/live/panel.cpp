#include "bench/live/panel.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "base/user_error.h"
#include "bench/live/controls.h"
#include "bench/scene/idle_options.h"
#include "hw/link/fault_link.h"

namespace wobblebench::bench {

namespace {

std::string_view key_of(std::string_view setting) {
  return setting.substr(0, setting.find('='));
}

bool has_key(const std::vector<std::string>& settings, std::string_view key) {
  return std::ranges::any_of(settings, [&](const auto& other) { return key_of(other) == key; });
}

void put_over(std::vector<std::string>& page, const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) {
    std::erase_if(page, [&](const auto& other) { return key_of(other) == key_of(setting); });
    page.push_back(setting);
  }
}

/// All that a stream is made by, beside the renderer's settings.
nlohmann::ordered_json stream_part(const Scene& scene) {
  nlohmann::ordered_json all = resolved(scene);
  nlohmann::ordered_json mid_volume = all["render"]["pipeline"]["mid_volume"];
  all.erase("render");
  all["mid_volume"] = std::move(mid_volume);
  return all;
}

/// The scene with another's stream, which may be a recording's.
ResolvedScene with_stream_of(Scene scene, const ResolvedScene& stream) {
  const Scene& from = stream.options();
  scene.probe = from.probe;
  scene.acquisition = from.acquisition;
  scene.simulation = from.simulation;
  std::optional<phantoms::Phantom> phantom;
  if (stream.subject()) phantom = stream.subject()->phantom;
  return resolve_scene(std::move(scene), phantom);
}

/// As `live` takes it.
SceneSource live_scene_source(const SceneArguments& arguments) {
  return [load = scene_source(arguments.file, arguments.settings)](
             const std::vector<std::string>& settings) {
    Scene scene = load(settings);
    refuse_program(scene, "live");
    if (!scene.given.contains("acquisition.volumes")) scene.acquisition.volumes = hw::kMostVolumes;
    return scene;
  };
}

}  // namespace

Scene load_live_scene(const std::filesystem::path& file, const std::vector<std::string>& settings) {
  return live_scene_source({file, settings})(settings);
}

LivePanel::LivePanel(SceneArguments arguments, bool with_scan, std::string faults)
    : arguments_(std::move(arguments)),
      with_scan_(with_scan),
      load_(live_scene_source(arguments_)),
      given_(load_(arguments_.settings)) {
  orders_.faults = std::move(faults);
}

std::vector<std::string> LivePanel::all_settings(const std::vector<std::string>& page) const {
  std::vector<std::string> all = arguments_.settings;
  all.insert(all.end(), page.begin(), page.end());
  return all;
}

std::uint64_t LivePanel::set(const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) check_control(setting, with_scan_);
  return take([&](Settings& page) { put_over(page, settings); });
}

std::uint64_t LivePanel::reset(const std::vector<std::string>& keys) {
  return take([&](Settings& page) {
    std::erase_if(page, [&](const auto& setting) {
      return keys.empty() || std::ranges::find(keys, key_of(setting)) != keys.end();
    });
  });
}

/// Nothing changes where this throws. The scene is made without the lock that the stream takes, and
/// once more where the pipeline has changed the state meanwhile.
std::uint64_t LivePanel::take(const std::function<void(Settings& page)>& edit,
                              const std::string& why) {
  const std::lock_guard one_by_one(changing_);
  std::unique_lock lock(mutex_);
  for (;;) {
    const auto before = state_;
    Settings page = page_settings_;
    lock.unlock();
    edit(page);
    Scene given = load_(all_settings(page));
    const bool wants_scan = !before || stream_part(given) != stream_part(before->given);
    std::optional<ResolvedScene> scene;
    if (!wants_scan) scene = with_stream_of(given, before->scene);
    lock.lock();
    if (state_ != before) continue;
    if (scene) {
      state_ = std::make_shared<const LiveState>(
          LiveState{serial_ + 1, all_settings(page), given, *std::move(scene)});
    }
    if (wants_scan || is_scan_wanted_) interrupt();
    is_scan_wanted_ = wants_scan;
    page_settings_ = std::move(page);
    given_ = std::move(given);
    why_ = why;
    note_change();
    return ++serial_;
  }
}

void LivePanel::interrupt() {
  ++orders_.interrupts;
  note_change();
}

void LivePanel::note_change() {
  ++version_;
  changed_.notify_all();
}

void LivePanel::set_faults(const std::string& faults) {
  if (!faults.empty()) hw::parse_faults(faults);
  const std::lock_guard lock(mutex_);
  orders_.faults = faults;
  interrupt();
}

void LivePanel::play(bool is_playing) {
  const std::lock_guard lock(mutex_);
  orders_.is_playing = is_playing;
  orders_.is_step = false;
  interrupt();
}

void LivePanel::step() {
  const std::lock_guard lock(mutex_);
  orders_.is_playing = orders_.is_step = true;
  interrupt();
}

void LivePanel::compare() {
  const std::lock_guard lock(mutex_);
  ++comparisons_;
}

std::uint64_t LivePanel::comparisons() const {
  const std::lock_guard lock(mutex_);
  return comparisons_;
}

std::optional<render::RenderOptions> LivePanel::start_options() const {
  const std::lock_guard lock(mutex_);
  if (!start_) return std::nullopt;
  return start_->render;
}

LiveOrders LivePanel::orders() const {
  const std::lock_guard lock(mutex_);
  return orders_;
}

std::uint64_t LivePanel::interrupts() const {
  const std::lock_guard lock(mutex_);
  return orders_.interrupts;
}

void LivePanel::wait(const LiveOrders& known,
                     std::uint64_t serial,
                     std::chrono::milliseconds time) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, time, [&] {
    return orders_.interrupts != known.interrupts || (state_ && state_->serial != serial);
  });
}

WantedScene LivePanel::wanted() const {
  const std::lock_guard lock(mutex_);
  return {given_, all_settings(page_settings_)};
}

bool LivePanel::is_scan_wanted() const {
  const std::lock_guard lock(mutex_);
  return is_scan_wanted_;
}

void LivePanel::adopt(const WantedScene& wanted, const ResolvedScene& scene) {
  const std::lock_guard lock(mutex_);
  is_scan_wanted_ = stream_part(wanted.given) != stream_part(given_);
  // Settings of the renderer may have changed while the stream was made.
  const WantedScene newest =
      is_scan_wanted_ ? wanted : WantedScene{given_, all_settings(page_settings_)};
  state_ = std::make_shared<const LiveState>(
      LiveState{++serial_, newest.settings, newest.given, with_stream_of(newest.given, scene)});
  if (!start_) start_ = state_->scene.options();
  note_change();
}

void LivePanel::revert(const std::shared_ptr<const LiveState>& to,
                       const std::vector<std::string>& refused,
                       const std::string& why) {
  const auto own = static_cast<std::ptrdiff_t>(arguments_.settings.size());
  const Settings earlier(to->settings.begin() + own, to->settings.end());
  const Settings tried(refused.begin() + own, refused.end());
  const auto keep_later = [&](Settings& page) {
    Settings later = std::exchange(page, earlier);
    std::erase_if(page, [&](const auto& setting) {  // reset since
      return has_key(tried, key_of(setting)) && !has_key(later, key_of(setting));
    });
    std::erase_if(later, [&](const auto& setting) {
      return std::ranges::find(tried, setting) != tried.end();
    });
    put_over(page, later);
  };
  try {
    take(keep_later, why);
  } catch (const UserError&) {  // they hold with what was refused alone
    take([&](Settings& page) { page = earlier; }, why);
  }
}

void LivePanel::set_stage(const std::string& stage) {
  const std::lock_guard lock(mutex_);
  if (std::exchange(stage_, stage) != stage) note_change();
}

void LivePanel::rest() {
  const std::lock_guard lock(mutex_);
  if (stage_ == "ended" || stage_ == "paused") return;
  stage_ = "paused";
  note_change();
}

void LivePanel::end_stage(const LiveOrders& known,
                          const std::string& stage,
                          const std::string& why) {
  const std::lock_guard lock(mutex_);
  if (orders_.interrupts == known.interrupts) orders_.is_playing = orders_.is_step = false;
  stage_ = stage;
  if (!why.empty()) why_ = why;
  note_change();
}

namespace {

/// What each setting that is without effect in the scene would act with, by its key.
nlohmann::ordered_json idle_json(const Scene& scene,
                                 const nlohmann::ordered_json& values,
                                 SampleSource source) {
  std::set<std::string> keys;
  for (const auto& [key, value] : values_by_key(values)) keys.insert(key);
  nlohmann::ordered_json idle = nlohmann::ordered_json::object();
  for (const IdleOption& option : idle_options(scene, keys, source)) {
    idle[option.key] = option.acts_with;
  }
  return idle;
}

}  // namespace

std::shared_ptr<const LiveState> LivePanel::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

nlohmann::ordered_json LivePanel::status() const {
  const std::lock_guard lock(mutex_);
  nlohmann::ordered_json json = {{"type", "status"},
                                 {"serial", serial_},
                                 {"stage", stage_},
                                 {"why", why_},
                                 {"faults", orders_.faults},
                                 {"settings", page_settings_}};
  // What the scene leaves open is known once its stream is there.
  if (start_) json["start"] = resolved(*start_);
  const bool is_known = state_ && !is_scan_wanted_;
  const Scene& scene = is_known ? state_->scene.options() : given_;
  json["values"] = resolved(scene);
  const bool has_subject = is_known && state_->scene.subject().has_value();
  json["idle"] = idle_json(scene,
                           json["values"],
                           with_scan()   ? SampleSource::simulator
                           : has_subject ? SampleSource::recording_of_scene
                                         : SampleSource::unknown_subject);
  return json;
}

std::uint64_t LivePanel::wait_for_status(std::uint64_t version,
                                         std::chrono::milliseconds time) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, time, [&] { return version_ != version; });
  return version_;
}

}  // namespace wobblebench::bench
