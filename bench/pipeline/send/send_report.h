// What the report of a stream says of what was sent.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/output/document/table.h"
#include "bench/pipeline/send/stream_sender.h"

namespace wobblebench::bench {

nlohmann::ordered_json send_json(const SendReport& report);
/// Lines for a terminal.
std::string send_text(const SendReport& report);
/// Messages that were made, by kind; and what each client took of them.
Table sent_table(const SendReport& report);
Table clients_table(const SendReport& report);

}  // namespace wobblebench::bench
