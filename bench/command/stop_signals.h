// Signals that end a command in order.
#pragma once

namespace wobblebench::bench {

/// From now on the first SIGINT, SIGTERM or SIGHUP asks the command to stop, and a second one ends
/// the program. A signal that was ignored stays so.
void stop_in_order();
bool stop_requested();

}  // namespace wobblebench::bench
