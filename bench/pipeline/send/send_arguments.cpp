#include "bench/pipeline/send/send_arguments.h"

#include <map>
#include <sstream>
#include <stdexcept>

#include "base/user_error.h"
#include "hw/link/link_arguments.h"

namespace wobblebench::bench {

namespace {

void choose_content(SendArguments& arguments) {
  const std::map<std::string, bool*> flags = {{"picture", &arguments.picture},
                                              {"volume", &arguments.volume},
                                              {"polar", &arguments.polar},
                                              {"surface", &arguments.surface},
                                              {"pose", &arguments.pose}};
  std::istringstream names(arguments.options.content);
  bool is_good = !arguments.options.content.empty() && !arguments.options.content.ends_with('+');
  for (std::string name; is_good && std::getline(names, name, '+');) {
    const auto found = flags.find(name);
    is_good = found != flags.end() && !*found->second;
    if (is_good) *found->second = true;
  }
  if (is_good) return;
  throw InvalidOption("content",
                      arguments.options.content,
                      "must be of picture, volume, polar, surface and pose, with + between them");
}

void refuse_idle(const hw::LinkArguments& given, const SendArguments& arguments) {
  const auto refuse = [&](const char* key, bool acts, const char* with) {
    const auto found = given.settings.find(key);
    if (acts || found == given.settings.end()) return;
    throw InvalidOption(key, found->second, std::string("acts with content=") + with);
  };
  refuse("spacing_mm", arguments.volume, "volume");
  refuse("type", arguments.volume || arguments.polar, "volume or polar");
}

}  // namespace

SendArguments parse_send(const std::string& text) {
  const auto refusal = [&](const std::string& why) {
    return UserError("--send = " + text + ": " + why);
  };
  SendArguments arguments{.text = text, .endpoint = {}, .options = {}};
  try {
    const hw::LinkArguments given = hw::parse_link_arguments(text);
    if (given.link != "igtl") {
      throw refusal("must be igtl=PORT or igtl=HOST:PORT, then ,key=value …");
    }
    arguments.endpoint = parse_endpoint(given.value, 0);
    hw::LinkSettings settings(given);
    settings.read(arguments.options);
    settings.finish("igtl");
    choose_content(arguments);
    refuse_idle(given, arguments);
    if (arguments.options.wait > arguments.options.clients) {
      throw InvalidOption("wait",
                          std::to_string(arguments.options.wait),
                          "must be at most clients=" + std::to_string(arguments.options.clients));
    }
  } catch (const InvalidOption& error) {
    throw refusal(error.what());
  } catch (const std::invalid_argument& error) {
    throw refusal(error.what());
  }
  return arguments;
}

}  // namespace wobblebench::bench
