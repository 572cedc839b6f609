#include "bench/live/server/request_check.h"

#include <algorithm>
#include <array>

namespace wobblebench::bench {

namespace {

/// IPv6 addresses stand in brackets in front of a port.
std::string host_name(const std::string& address) {
  if (address.find(':') == std::string::npos) return address;
  return std::string("[").append(address).append("]");
}

bool is_any_address(const std::string& address) {
  return address == "0.0.0.0" || address == "::";
}

bool names_server(std::string_view host, const ServedAs& server) {
  const std::string port = std::string(":").append(std::to_string(server.port));
  if (!host.ends_with(port)) return server.port == 80 && host == host_name(server.address);
  host.remove_suffix(port.size());
  // A server on every address has names that it does not know; the token protects it.
  if (is_any_address(server.address)) return true;
  constexpr std::array<std::string_view, 3> kLoopback = {"127.0.0.1", "localhost", "[::1]"};
  return host == host_name(server.address) || std::ranges::find(kLoopback, host) != kLoopback.end();
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
  if (!names_server(request.host, server)) return "Host is not this server";
  std::string own = "http://";
  own += request.host;
  if (!request.origin.empty() && request.origin != own) return "Origin is not this server's page";
  if (request.is_socket && request.origin.empty()) return "Origin is missing";
  if (server.token.empty() || !needs_token(path_of(request.target))) return "";
  return equal_secrets(token_of(request.target), server.token)
             ? ""
             : "the token is missing or wrong; open the address that the program printed";
}

}  // namespace wobblebench::bench
