#include "bench/live/panel.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/user_error.h"
#include "bench/live/controls.h"
#include "hw/link/fault_link.h"

namespace wobblebench::bench {

namespace {

std::string_view key_of(std::string_view setting) {
  return setting.substr(0, setting.find('='));
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

}  // namespace

Scene load_live_scene(const std::filesystem::path& file, const std::vector<std::string>& settings) {
  Scene scene = load_scene(file, settings);
  refuse_program(scene, "live");
  if (!scene.given.contains("acquisition.volumes")) scene.acquisition.volumes = hw::kMostVolumes;
  return scene;
}

LivePanel::LivePanel(SceneArguments arguments, bool with_scan, std::string faults)
    : arguments_(std::move(arguments)),
      with_scan_(with_scan),
      given_(load_live_scene(arguments_.file, arguments_.settings)) {
  orders_.faults = std::move(faults);
}

std::vector<std::string> LivePanel::all_settings(const std::vector<std::string>& page) const {
  std::vector<std::string> all = arguments_.settings;
  all.insert(all.end(), page.begin(), page.end());
  return all;
}

std::uint64_t LivePanel::set(const std::vector<std::string>& settings) {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> page = page_settings_;
  for (const std::string& setting : settings) {
    check_control(setting, with_scan_);
    std::erase_if(page, [&](const auto& other) { return key_of(other) == key_of(setting); });
    page.push_back(setting);
  }
  return take(std::move(page));
}

std::uint64_t LivePanel::reset(const std::vector<std::string>& keys) {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> page = page_settings_;
  std::erase_if(page, [&](const auto& setting) {
    return keys.empty() || std::ranges::find(keys, key_of(setting)) != keys.end();
  });
  return take(std::move(page));
}

/// With the lock. Nothing changes where this throws.
std::uint64_t LivePanel::take(std::vector<std::string> page) {
  Scene given = load_live_scene(arguments_.file, all_settings(page));
  const bool wants_scan = !state_ || stream_part(given) != stream_part(state_->given);
  if (!wants_scan) {
    state_ = std::make_shared<const LiveState>(
        LiveState{serial_ + 1, all_settings(page), given, with_stream_of(given, state_->scene)});
  }
  if (wants_scan || is_scan_wanted_) interrupt();
  is_scan_wanted_ = wants_scan;
  page_settings_ = std::move(page);
  given_ = std::move(given);
  why_.clear();
  note_change();
  return ++serial_;
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

void LivePanel::revert(const std::shared_ptr<const LiveState>& to, const std::string& why) {
  const std::lock_guard lock(mutex_);
  state_ =
      std::make_shared<const LiveState>(LiveState{++serial_, to->settings, to->given, to->scene});
  given_ = to->given;
  const auto own = static_cast<std::ptrdiff_t>(arguments_.settings.size());
  page_settings_ = {to->settings.begin() + own, to->settings.end()};
  is_scan_wanted_ = false;
  why_ = why;
  note_change();
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
  json["values"] = resolved(state_ && !is_scan_wanted_ ? state_->scene.options() : given_);
  return json;
}

std::uint64_t LivePanel::wait_for_status(std::uint64_t version,
                                         std::chrono::milliseconds time) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, time, [&] { return version_ != version; });
  return version_;
}

}  // namespace wobblebench::bench
