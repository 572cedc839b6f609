// Which requests the live page's server answers: those of its own page.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wobblebench::bench {

/// What a request says of itself.
struct RequestFacts {
  std::string_view host;    ///< header Host
  std::string_view origin;  ///< header Origin; empty: none
  std::string_view target;  ///< path and query
  bool is_socket = false;   ///< asks for a WebSocket
};

/// What requests must bring, and where they may come from.
struct ServedAs {
  std::string token;               ///< empty: none is asked for
  std::vector<std::string> names;  ///< in lower case, of proxies that it is behind
};

/// Why a request is refused, as one line; empty: it is answered. Without a token Host must be this
/// machine, so that no other site's name leads here (DNS rebinding), at any port, which a tunnel
/// may change; the page of a WebSocket must be the server's own (Origin); the token must be in the
/// query, token=….
std::string why_refused(const RequestFacts& request, const ServedAs& server);

/// The target without its query.
std::string_view path_of(std::string_view target);

}  // namespace wobblebench::bench
