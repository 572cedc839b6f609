#include "bench/report/board_report.h"

namespace wobblebench::bench {

using Json = nlohmann::ordered_json;

Json account_json(const hw::BoardAccount& account) {
  return {{"emitted", account.emitted},
          {"delivered", account.delivered},
          {"lost",
           {{"ring_full", account.lost.ring_full},
            {"link", account.lost.link},
            {"corrupt", account.lost.corrupt},
            {"out_of_order", account.lost.out_of_order}}},
          {"duplicates", account.duplicates}};
}

Json link_json(const hw::LinkCapabilities& link) {
  return {{"provenance", hw::to_string(link.origin)},
          {"copy_in", link.copy_in},
          {"waits_for_reader", link.waits_for_reader},
          {"buffer_bytes", link.buffer_bytes},
          {"buffers", link.buffers},
          {"buffers_per_interrupt", link.buffers_per_interrupt}};
}

Json board_json(const Acquisition& acquisition) {
  Json json = account_json(acquisition.account);
  json["damage"] = {{"places", acquisition.damage.regions},
                    {"bytes_skipped", acquisition.damage.bytes_skipped}};
  json["samples_from"] = hw::to_string(acquisition.source);
  json["volume"] = acquisition.volume.volume_index();
  json["missing_sticks"] = acquisition.volume.missing_sticks();
  json["ending"] = acquisition.ending.empty() ? Json(nullptr) : Json(acquisition.ending);
  json["link"] = link_json(acquisition.link);
  json["transport_ms"] = acquisition.transport_ms;
  return json;
}

}  // namespace wobblebench::bench
