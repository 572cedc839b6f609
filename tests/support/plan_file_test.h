// A fixture for readers of plans: text in, plan or refusal out.
#pragma once

#include <fstream>
#include <string>

#include "base/user_error.h"
#include "tests/support/folder_test.h"

namespace wobblebench::testing_support {

/// `kLoad`: a function of a plan's path.
template <auto kLoad>
class PlanFileTest : public FolderTest {
 protected:
  auto load(const std::string& text) {
    std::ofstream(folder_ / "plan.toml") << text;
    return kLoad(folder_ / "plan.toml");
  }
  /// Empty: it is not refused.
  std::string refusal(const std::string& text) {
    try {
      load(text);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }
};

}  // namespace wobblebench::testing_support
