// Which requests the live page's server answers: those of its own page.
#pragma once

#include <string>
#include <string_view>

namespace wobblebench::bench {

/// What a request says of itself.
struct RequestFacts {
  std::string_view host;    ///< header Host
  std::string_view origin;  ///< header Origin; empty: none
  std::string_view target;  ///< path and query
  bool is_socket = false;   ///< asks for a WebSocket
};

/// The server's address, as --listen gives it, and port; the token that requests must bring.
struct ServedAs {
  std::string address;
  int port = 0;
  std::string token;  ///< empty: none is asked for
};

/// Why a request is refused, as one line; empty: it is answered. Host must name this server, so
/// that no other site's name leads here (DNS rebinding); the page of a WebSocket must be the
/// server's own (Origin); the token must be in the query, token=….
std::string why_refused(const RequestFacts& request, const ServedAs& server);

/// The target without its query.
std::string_view path_of(std::string_view target);

}  // namespace wobblebench::bench
