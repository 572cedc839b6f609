#include "bench/pipeline/send/send_report.h"

#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "base/units.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kMegabyte = 1e6;

std::string dropped_text(const IgtlClientReport& client) {
  const std::uint64_t dropped = client.replaced + client.left;
  if (dropped == 0) return "";
  return "; " + std::to_string(dropped) + " dropped, because the client was slower";
}

}  // namespace

Json send_json(const SendReport& report) {
  const SendOptions& options = report.arguments.options;
  return {{"address", report.address},
          {"content", options.content},
          {"spacing_mm", options.spacing_m / kMillimetre},
          {"type", options.type == SendType::u8 ? "uint8" : "uint16"},
          {"axes", options.axes == SendAxes::ras ? "ras" : "lps"},
          {"header", options.header},
          {"messages", to_json(sent_table(report))},
          {"clients", to_json(clients_table(report))},
          {"more_clients", report.server.more_clients},
          {"refused_clients", report.server.refused}};
}

std::string send_text(const SendReport& report) {
  std::string text = "sent at     " + report.address + ": ";
  const std::size_t count = report.server.clients.size() + report.server.more_clients;
  text += count == 0 ? "no client connected\n" : std::to_string(count) + " clients\n";
  if (count == 1) text.replace(text.size() - 2, 1, "");
  for (const IgtlClientReport& client : report.server.clients) {
    text += "  " + client.address + "  " + std::to_string(client.sent) + " messages, " +
            significant(static_cast<double>(client.bytes) / kMegabyte, 4) + " MB in " +
            fixed(client.seconds, 1) + " s" + dropped_text(client) + "; " + client.ending + "\n";
  }
  if (report.server.refused > 0) {
    text += "  " + std::to_string(report.server.refused) + " connections refused: beyond clients=" +
            std::to_string(report.arguments.options.clients) + " at once\n";
  }
  return text;
}

Table sent_table(const SendReport& report) {
  Table table{.name = "sent",
              .caption = "Messages made for " + report.address +
                         ", and those that a later one overtook before they were made",
              .columns = {{"device"}, {"made"}, {"superseded"}}};
  for (const auto& [device, kind] : report.kinds) {
    table.add({Cell::code(device), kind.made, kind.superseded});
  }
  return table;
}

Table clients_table(const SendReport& report) {
  using C = IgtlClientReport;
  return table_of<C>(
      {.name = "clients",
       .caption = "Clients, and messages that each did not get because it was too slow: "
                  "replaced by a later one, or left when the connection ended"},
      report.server.clients,
      {{{"address"}, &C::address},
       {{"seconds", "connected", "s", 1}, &C::seconds},
       {{"sent", "messages"}, &C::sent},
       {{"bytes", "sent", "bytes"}, &C::bytes},
       {{"replaced"}, &C::replaced},
       {{"left"}, &C::left},
       {{"ending", "end"}, &C::ending}});
}

}  // namespace wobblebench::bench
