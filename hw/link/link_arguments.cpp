#include "hw/link/link_arguments.h"

#include <algorithm>
#include <charconv>

namespace wobblebench::hw {
namespace {

bool is_key(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || c == '_';
  });
}

/// End of the setting that starts at `from`: a ',' before the next "key=", or the end of the text.
std::size_t end_of_setting(const std::string& text, std::size_t from) {
  for (std::size_t comma = text.find(',', from); comma != std::string::npos;
       comma = text.find(',', comma + 1)) {
    const std::size_t equals = text.find('=', comma);
    if (equals == std::string::npos) return text.size();
    if (is_key(std::string_view(text).substr(comma + 1, equals - comma - 1))) return comma;
  }
  return text.size();
}

/// The whole of `text` as a number; none if it is not one.
template <class T>
std::optional<T> parse_whole(const std::string& text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) return {};
  return value;
}

}  // namespace

LinkArguments parse_link_arguments(const std::string& text) {
  LinkArguments arguments;
  bool first = true;
  for (std::size_t at = 0; first || at < text.size();) {
    const std::size_t end = end_of_setting(text, at);
    const std::string setting = text.substr(at, end - at);
    const std::size_t equals = setting.find('=');
    const std::string key = setting.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : setting.substr(equals + 1);
    if (!is_key(key)) throw InvalidOption("link", setting, "must be NAME or NAME=PATH");
    if (first) {
      arguments.link = key;
      arguments.value = value;
    } else if (!arguments.settings.emplace(key, value).second) {
      throw InvalidOption(key, value, "stands twice");
    }
    first = false;
    at = end + 1;
  }
  return arguments;
}

std::optional<std::string> LinkSettings::take(std::string_view key) {
  known_keys_.emplace_back(key);
  const auto found = unused_.find(std::string(key));
  if (found == unused_.end()) return {};
  std::string value = std::move(found->second);
  unused_.erase(found);
  return value;
}

void LinkSettings::finish(const std::string& link) const {
  if (unused_.empty()) return;
  std::string keys;
  for (const std::string& key : known_keys_) keys += (keys.empty() ? "" : ", ") + key;
  const auto& [key, value] = *unused_.begin();
  throw InvalidOption(key, value, "no such key; " + link + " takes " + keys);
}

double LinkSettings::number(std::string_view key, const std::string& text) {
  if (const auto value = parse_whole<double>(text)) return *value;
  throw InvalidOption(key, text, "must be a number");
}

void LinkSettings::integer(std::string_view key, int& value, int min, int max) {
  const auto text = take(key);
  if (!text) return;
  const auto given = parse_whole<int>(*text);
  if (!given) {
    throw InvalidOption(
        key,
        *text,
        "must be a whole number within " + std::to_string(min) + " and " + std::to_string(max));
  }
  value = *given;
}

void LinkSettings::seed(std::string_view key, std::uint64_t& value) {
  const auto text = take(key);
  if (!text) return;
  const auto given = parse_whole<std::uint64_t>(*text);
  if (!given) throw InvalidOption(key, *text, "must be a whole number from 0 to 2^64 - 1");
  value = *given;
}

void LinkSettings::flag(std::string_view key, bool& value) {
  const auto text = take(key);
  if (!text) return;
  if (*text != "true" && *text != "false") throw InvalidOption(key, *text, "must be true or false");
  value = *text == "true";
}

}  // namespace wobblebench::hw
