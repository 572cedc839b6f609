// Parses the --board argument, LINK[=VALUE][,key=value]…: "file=face.wbst,loop=true" or
// "sim,faults=drop:0.01+unplug@5000".
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/options.h"

namespace wobblebench::hw {

struct LinkArguments {
  std::string link;   ///< "sim", "file", "xdma"
  std::string value;  ///< after its '=': a path
  std::map<std::string, std::string> settings;
};

/// A ',' separates settings only where "key=" follows it; any other is part of the value before, so
/// that a path may contain one. Throws InvalidOption where the link has no name, or a key is
/// repeated.
LinkArguments parse_link_arguments(const std::string& text);

/// The visitor that sets options from the settings of a link's arguments. Each describe() removes
/// the keys that it has; finish() rejects those that remain.
class LinkSettings {
 public:
  explicit LinkSettings(const LinkArguments& arguments) : unused_(arguments.settings) {}

  /// Sets and range-checks `options`. Throws InvalidOption.
  template <class Options>
  void read(Options& options) {
    describe(options, *this);
    check_options(options);
  }

  /// Throws InvalidOption "KEY = VALUE: no such key; LINK takes …" for a setting that is not used.
  void finish(const std::string& link) const;

  void real(std::string_view key, double& value, double unit, double, double) {
    if (const auto text = take(key)) value = number(key, *text) * unit;
  }
  void integer(std::string_view key, int& value, int min, int max);
  void seed(std::string_view key, std::uint64_t& value);
  void flag(std::string_view key, bool& value);
  void text(std::string_view key, std::string& value) {
    if (auto given = take(key)) value = *given;
  }
  template <class Enum>
  void choice(std::string_view key,
              Enum& value,
              std::initializer_list<std::pair<std::string_view, Enum>> names) {
    const auto given = take(key);
    if (!given) return;
    std::string allowed = "must be one of";
    for (const auto& [name, meaning] : names) {
      if (*given == name) {
        value = meaning;
        return;
      }
      allowed += (allowed.ends_with("of") ? " " : ", ") + std::string(name);
    }
    throw InvalidOption(key, *given, allowed);
  }

 private:
  std::optional<std::string> take(std::string_view key);
  static double number(std::string_view key, const std::string& text);

  std::map<std::string, std::string> unused_;
  std::vector<std::string> known_keys_;
};

}  // namespace wobblebench::hw
