#include "bench/live/server/request_check.h"

#include <algorithm>
#include <array>
#include <ranges>

#include "base/text.h"

namespace wobblebench::bench {

namespace {

/// A host in lower case, without its port. IPv6 addresses stand in brackets in front of one.
std::string name_of(std::string_view host) {
  const auto port = host.find(':', host.starts_with('[') ? host.find(']') : 0);
  return lower_case(host.substr(0, port));
}

bool contains(std::ranges::range auto&& names, const std::string& name) {
  return std::ranges::find(names, name) != std::ranges::end(names);
}

bool names_server(std::string_view host, const ServedAs& server) {
  // Behind a tunnel or proxy it has names and ports that it does not know; the token protects it.
  if (!server.token.empty()) return true;
  constexpr std::array<std::string_view, 3> kLoopback = {"127.0.0.1", "localhost", "[::1]"};
  return contains(kLoopback, name_of(host));
}

bool is_own_page(std::string_view origin, std::string_view host, const ServedAs& server) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (!origin.starts_with(scheme)) continue;
    origin.remove_prefix(scheme.size());
    if (lower_case(origin) == lower_case(host)) return true;
    // What a proxy makes of Host may lack the port, or name the server behind it.
    const std::string name = name_of(origin);
    return !server.token.empty() && (name == name_of(host) || contains(server.names, name));
  }
  return false;
}

/// In a time that does not tell how much of it is right.
bool equal_secrets(std::string_view one, std::string_view other) {
  if (one.size() != other.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    difference |= static_cast<unsigned>(static_cast<unsigned char>(one[i]) ^
                                        static_cast<unsigned char>(other[i]));
  }
  return difference == 0;
}

std::string_view token_of(std::string_view target) {
  constexpr std::string_view kName = "token=";
  const auto query = target.find('?');
  if (query == std::string_view::npos) return {};
  target.remove_prefix(query + 1);
  while (!target.empty()) {
    const auto end = std::min(target.find('&'), target.size());
    if (target.substr(0, end).starts_with(kName)) {
      return target.substr(kName.size(), end - kName.size());
    }
    target.remove_prefix(std::min(end + 1, target.size()));
  }
  return {};
}

/// Style, script and icon are the same for everybody.
bool needs_token(std::string_view path) {
  return path == "/" || path == "/socket";
}

}  // namespace

std::string_view path_of(std::string_view target) {
  return target.substr(0, target.find('?'));
}

std::string why_refused(const RequestFacts& request, const ServedAs& server) {
  if (!names_server(request.host, server)) {
    return "Host is not this server: without a token it is localhost, 127.0.0.1 or [::1]; live "
           "--name takes others";
  }
  if (!request.origin.empty() && !is_own_page(request.origin, request.host, server)) {
    return "Origin is not this server's page; behind a proxy, live --name takes its name";
  }
  if (request.is_socket && request.origin.empty()) return "Origin is missing";
  if (server.token.empty() || !needs_token(path_of(request.target))) return "";
  return equal_secrets(token_of(request.target), server.token)
             ? ""
             : "the token is missing or wrong; open the address that the program printed";
}

}  // namespace wobblebench::bench
