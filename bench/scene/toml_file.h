// A TOML file of the user, and the visitor that reads an options struct from one of its sections.
#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/near_name.h"
#include "base/options.h"
#include "base/user_error.h"

namespace wobblebench::bench {

/// `what` the file should be, "a scene" say, for refusals. Throws UserError "PATH: reason" for what
/// is no file, is too large, nests too deep or is not TOML; as read_file() where it cannot be read.
toml::table parse_toml_file(const std::filesystem::path& path, const std::string& what);

/// Why a table that nests too deep is refused.
std::string too_deep_toml();

/// Reads one section. Each key read is removed from the table; those left are unknown.
class TomlReader {
 public:
  TomlReader(std::string source, std::string section, toml::table& table)
      : source_(std::move(source)), section_(std::move(section)), table_(table) {}

  void real(std::string_view key, double& value, double unit, double, double) {
    take(key, "a number", [&](const toml::node& node) { return read_number(node, value, unit); });
  }
  void real_or_auto(
      std::string_view key, std::optional<double>& value, double unit, double, double) {
    take(key, "a number or \"auto\"", [&](const toml::node& node) {
      if (node.is_string() && node.as_string()->get() == kAuto) {
        value.reset();
        return true;
      }
      double read = 0;
      if (!read_number(node, read, unit)) return false;
      value = read;
      return true;
    });
  }
  void integer(std::string_view key, int& value, int min, int max) {
    take(key, "a whole number", [&](const toml::node& node) {
      const auto number = node.as_integer();
      if (!number) return false;
      // Checked here, before the conversion to int.
      if (number->get() < min || number->get() > max) {
        fail(key, node, "must be within " + std::to_string(min) + " and " + std::to_string(max));
      }
      value = static_cast<int>(number->get());
      return true;
    });
  }
  void seed(std::string_view key, std::uint64_t& value) {
    take(key, "a whole number, 0 or more", [&](const toml::node& node) {
      const auto number = node.as_integer();
      if (!number || number->get() < 0) return false;
      value = static_cast<std::uint64_t>(number->get());
      return true;
    });
  }
  void flag(std::string_view key, bool& value) {
    take(key, "true or false", [&](const toml::node& node) {
      if (!node.is_boolean()) return false;
      value = node.as_boolean()->get();
      return true;
    });
  }
  void text(std::string_view key, std::string& value) {
    take(key, "a text in quotes", [&](const toml::node& node) {
      if (!node.is_string()) return false;
      value = node.as_string()->get();
      return true;
    });
  }
  void texts(std::string_view key, std::vector<std::string>& values) {
    take(key, "a list of texts in quotes", [&](const toml::node& node) {
      if (!node.is_array()) return false;
      std::vector<std::string> read;
      for (const toml::node& element : *node.as_array()) {
        if (!element.is_string()) return false;
        read.push_back(element.as_string()->get());
      }
      values = std::move(read);
      return true;
    });
  }
  /// May be given, as in a resolved scene, but with no other value.
  void constant(std::string_view key, std::string_view text) {
    take(key, "left out, it follows from other keys", [&](const toml::node& node) {
      return node.is_string() && node.as_string()->get() == text;
    });
  }
  template <class Enum>
  void choice(std::string_view key,
              Enum& value,
              std::initializer_list<std::pair<std::string_view, Enum>> names) {
    std::string allowed = "one of";
    for (const auto& [name, unused] : names) allowed += " \"" + std::string(name) + "\"";
    take(key, allowed, [&](const toml::node& node) {
      for (const auto& [name, candidate] : names) {
        if (node.is_string() && node.as_string()->get() == name) {
          value = candidate;
          return true;
        }
      }
      if (node.is_string()) {
        std::vector<std::string> known;
        for (const auto& [name, unused] : names) known.emplace_back(name);
        fail(key, node, "must be " + allowed + did_you_mean(node.as_string()->get(), known));
      }
      return false;
    });
  }
  void reals(std::string_view key, std::vector<double>& values, double unit, double, double) {
    take(key, "a list of numbers", [&](const toml::node& node) {
      return read_numbers(node, values, unit);
    });
  }
  void vec3(std::string_view key, glm::dvec3& value, double unit, double, double) {
    take(key, "a list of numbers", [&](const toml::node& node) {
      std::vector<double> read;
      if (!read_numbers(node, read, unit)) return false;
      if (read.size() != 3) {
        fail(key, std::to_string(read.size()) + " numbers", "takes 3 numbers");
      }
      value = {read[0], read[1], read[2]};
      return true;
    });
  }

  const std::vector<std::string>& known_keys() const { return known_; }
  const std::vector<std::string>& given_keys() const { return given_; }

  [[noreturn]] void fail(std::string_view key,
                         const toml::node& node,
                         const std::string& allowed) const {
    std::ostringstream value;
    node.visit([&](const auto& concrete) {
      if constexpr (toml::is_value<decltype(concrete)>) {
        value << concrete;
      } else {
        value << (toml::is_array<decltype(concrete)> ? "[...]" : "{...}");
      }
    });
    fail(key, value.str(), allowed);
  }

 private:
  [[noreturn]] void fail(std::string_view key,
                         const std::string& value,
                         const std::string& allowed) const {
    throw UserError(source_ + ": " + section_ + "." + std::string(key) + " = " + value + ": " +
                    allowed);
  }

  template <class Read>
  void take(std::string_view key, const std::string& allowed, const Read& read) {
    known_.emplace_back(key);
    const toml::node* node = table_.get(key);
    if (!node) return;
    if (!read(*node)) fail(key, *node, "must be " + allowed);
    given_.push_back(section_ + "." + std::string(key));
    table_.erase(key);
  }

  static bool read_number(const toml::node& node, double& value, double unit) {
    if (node.is_integer()) {
      value = static_cast<double>(node.as_integer()->get()) * unit;
    } else if (node.is_floating_point()) {
      value = node.as_floating_point()->get() * unit;
    } else {
      return false;
    }
    return true;
  }

  static bool read_numbers(const toml::node& node, std::vector<double>& values, double unit) {
    if (!node.is_array()) return false;
    std::vector<double> read;
    for (const toml::node& element : *node.as_array()) {
      if (!read_number(element, read.emplace_back(), unit)) return false;
    }
    values = std::move(read);
    return true;
  }

  std::string source_;
  std::string section_;
  toml::table& table_;
  std::vector<std::string> known_;
  std::vector<std::string> given_;
};

}  // namespace wobblebench::bench
