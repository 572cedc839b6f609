#include "bench/live/requests.h"

#include <exception>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "base/text.h"
#include "base/user_error.h"
#include "bench/command/program.h"
#include "bench/evaluation/head_pose/find_head.h"
#include "bench/live/controls.h"
#include "bench/output/image_io.h"
#include "bench/output/page/page_text.h"
#include "bench/scene/scene_text.h"
#include "hw/link/fault_link.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostSettings = 200;  ///< of one request

std::vector<std::string> texts_of(const nlohmann::json& request, const char* key) {
  auto texts = request.at(key).get<std::vector<std::string>>();
  if (texts.size() > kMostSettings) {
    throw UserError(std::string(key) + ": at most " + std::to_string(kMostSettings));
  }
  return texts;
}

Json fault_kinds() {
  Json kinds = Json::array();
  for (int i = 0; i < hw::kFaultKinds; ++i) {
    kinds.push_back(hw::to_string(static_cast<hw::FaultKind>(i)));
  }
  return kinds;
}

/// What a saved scene says of itself.
std::string heading(const std::string& command, const LivePicture& shown) {
  return "# Volume " + std::to_string(shown.volume) + " of a live page; the same picture:\n# " +
         command + "\n";
}

std::string run_command(const std::string& board) {
  return "wobblebench run scene.toml" + (board.empty() ? "" : " --board " + shell_word(board));
}

/// Why `run` makes another picture; empty: it makes the same.
std::string why_not_the_same(const LivePicture& shown, const LivePanel& panel) {
  const LiveState& state = *shown.state;
  const Scene again = load_live_scene(panel.arguments().file, state.settings);
  if (resolved(again) != resolved(state.given)) return "the scene file has changed since the start";
  if (state.scene.render().pipeline.mid_volume) {
    return "the picture may show two volumes (render.pipeline.mid_volume); run shows one";
  }
  if (!panel.with_scan()) {
    return "run shows the first volume that the board sends, here it is volume " +
           std::to_string(shown.volume);
  }
  if (shown.lost_sticks > 0) {
    return std::to_string(shown.lost_sticks) + " sticks of this volume were lost; run loses none";
  }
  return "";
}

}  // namespace

LiveRequests::LiveRequests(LivePanel& panel,
                           LivePipeline& pipeline,
                           std::string board,
                           std::string renderer)
    : panel_(panel),
      pipeline_(pipeline),
      board_(std::move(board)),
      renderer_(std::move(renderer)) {}

ServerCalls::Answer LiveRequests::take(const std::string& message) {
  ServerCalls::Answer to;
  Json reply;
  nlohmann::json id;
  try {
    const auto request = nlohmann::json::parse(message);
    if (!request.is_object()) throw UserError("a request must be a JSON object");
    if (request.contains("id") && request["id"].is_number_integer()) id = request["id"];
    reply = answer(request, to);
  } catch (const nlohmann::json::exception&) {
    reply = {{"type", "refused"}, {"why", "the request is malformed (docs/live.md)"}};
  } catch (const std::exception&) {
    reply = {{"type", "refused"}, {"why", refusal_of(std::current_exception()).line}};
  }
  reply["id"] = id;
  // A refusal may quote what is no UTF-8.
  to.text = reply.dump(-1, ' ', false, Json::error_handler_t::replace);
  return to;
}

Json LiveRequests::answer(const nlohmann::json& request, ServerCalls::Answer& to) {
  const auto what = request.at("do").get<std::string>();
  std::uint64_t serial = 0;
  if (what == "hello") return hello();
  if (what == "save") return saved();
  if (what == "history") return history();
  if (what == "set") {
    serial = panel_.set(texts_of(request, "settings"));
  } else if (what == "frame") {
    const SharedPicture shown = pipeline_.shown();
    if (!shown || !shown->frames) throw UserError("frame: no volume is whole yet");
    const hw::AcquisitionPlan& plan = shown->state->scene.plan();
    serial = panel_.set(find_head_view(plan, *shown->frames, "frame"));
  } else if (what == "reset") {
    serial = panel_.reset(texts_of(request, "keys"));
  } else if (what == "play" || what == "pause") {
    panel_.play(what == "play");
  } else if (what == "step") {
    panel_.step();
  } else if (what == "faults") {
    panel_.set_faults(request.at("faults").get<std::string>());
  } else if (what == "show") {
    const bool space = request.value("space", false);
    to.channels = ChannelSet{true,
                             true,
                             true,
                             request.at("maps").get<bool>(),
                             request.at("planes").get<bool>(),
                             true,
                             true,
                             space,
                             space};
  } else if (what == "compare") {
    panel_.compare();
  } else if (what == "past") {
    pipeline_.show_past(request.at("number").get<std::uint64_t>(),
                        request.at("of").get<std::string>());
  } else if (what != "ping") {
    throw UserError(
        "do = " + what +
        ": must be hello, ping, set, frame, reset, play, pause, step, faults, show, save, compare, "
        "history or past");
  }
  return {{"type", "done"}, {"serial", serial}};
}

Json LiveRequests::hello() {
  pipeline_.refresh();
  const auto state = panel_.state();
  if (!state) throw UserError("the first stream is being prepared");
  return {{"type", "hello"},
          {"controls", controls_json(state->given, panel_.with_scan())},
          {"scene", panel_.arguments().file.string()},
          {"board", board_},
          {"renderer", renderer_},
          {"faults", fault_kinds()},
          {"has_truth", state->scene.subject().has_value()}};
}

Json LiveRequests::history() const {
  return {{"type", "history"}, {"volumes", pipeline_.history().list()}};
}

Json LiveRequests::saved() const {
  const SharedPicture shown = pipeline_.shown();
  if (!shown) throw UserError("there is no picture yet");
  const bool is_simulated = panel_.with_scan();
  const LiveState& state = *shown->state;
  std::vector<std::string> settings = state.settings;
  if (state.given.given.contains("acquisition.volumes")) {
    settings.emplace_back("acquisition.volumes=1");  // run takes no other number
  }
  std::string board = is_simulated ? "" : board_;
  if (is_simulated && shown->volume > 0) {
    board = "sim,first_volume=" + std::to_string(shown->volume);
  }
  const std::string command = run_command(board);
  const std::vector<char> picture = png(shown->picture.surface, Values::light);
  return {{"type", "saved"},
          {"serial", state.serial},
          {"volume", shown->volume},
          {"toml", heading(command, *shown) + scene_text(panel_.arguments().file, settings)},
          {"command", command},
          {"why_not_the_same", why_not_the_same(*shown, panel_)},
          {"picture", base64({picture.data(), picture.size()})}};
}

}  // namespace wobblebench::bench
