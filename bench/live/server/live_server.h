// The server of the live page: HTTP and WebSocket on one port, in a library that is loaded for
// `live` alone, because Boost.Beast's templates would slow down every build and program.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wobblebench::bench {

/// Kinds of messages to viewers. Of each kind a viewer gets the newest one; older ones that still
/// wait are dropped.
enum class Channel : std::uint8_t {
  status,
  picture,
  times,
  maps,
  planes,
  past,      ///< what was asked of an earlier volume
  compared,  ///< a picture beside that of other settings
  space,     ///< probe, sticks and phantom
  firing     ///< the frame that has come
};
inline constexpr std::size_t kChannels = 9;
using ChannelSet = std::array<bool, kChannels>;

/// A message that all viewers share.
struct LiveMessage {
  std::shared_ptr<const std::string> bytes;  ///< null: none
  bool is_text = true;
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  int port = 0;                    ///< 0: any that is free
  std::string token;               ///< that each page and socket must bring; empty: none
  std::vector<std::string> names;  ///< in lower case, of proxies that it is behind
  int most_viewers = 8;
  std::size_t most_message_bytes = 65536;  ///< of a viewer's message
  int most_messages_per_s = 200;           ///< of a viewer; those beyond it wait
};

/// What the server's thread asks for. No function may throw or block.
struct ServerCalls {
  /// A file of the page; empty: there is none of this name.
  std::function<std::string_view(std::string_view name)> asset;
  struct Answer {
    std::string text;                    ///< sent to this viewer; empty: nothing
    std::optional<ChannelSet> channels;  ///< that the viewer wants from now on
  };
  std::function<Answer(const std::string& message)> take;
  /// A viewer's channels are now those of its answer.
  std::function<void()> channels_changed;
};

/// Serves until it is destroyed, which takes a few milliseconds. Each viewer has one message in
/// flight: the next one is sent when its page has said "seen". So a viewer that does not read
/// holds one message, and nothing waits for it.
class LiveServer {
 public:
  virtual ~LiveServer() = default;
  virtual int port() const = 0;
  /// May be called from any thread.
  virtual void publish(Channel channel, LiveMessage message) = 0;
  /// Whether a viewer wants it. May be called from any thread.
  virtual bool is_wanted(Channel channel) const = 0;
  virtual int viewers() const = 0;
};

/// Loads the library. Throws UserError "--listen = …" or "--port = …" where the address cannot be
/// used, std::runtime_error where the library cannot be loaded.
std::unique_ptr<LiveServer> make_live_server(const ServerOptions& options, ServerCalls calls);

}  // namespace wobblebench::bench
