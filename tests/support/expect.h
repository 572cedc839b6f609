// What tests of all rooms expect: parts of texts, and refusals.
#pragma once

#include <gtest/gtest.h>

#include <exception>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace wobblebench {

/// Whether `part` stands in `text`; where that is not as expected, both are shown.
inline testing::AssertionResult holds(std::string_view text, std::string_view part) {
  const bool found = text.find(part) != std::string_view::npos;
  return (found ? testing::AssertionSuccess() : testing::AssertionFailure())
         << "\"" << part << "\" in: " << text;
}

/// What `function` is refused with by an `Error`; empty: it is not.
template <class Error = std::exception, class Function>
std::string refusal_of(const Function& function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// "run --out a" as {"run", "--out", "a"}.
inline std::vector<std::string> words_of(const std::string& line) {
  std::istringstream text(line);
  return {std::istream_iterator<std::string>(text), std::istream_iterator<std::string>()};
}

}  // namespace wobblebench
