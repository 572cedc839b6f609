// A fixture for readers of plans: text in, plan or refusal out.
#pragma once

#include <fstream>
#include <string>

#include "base/user_error.h"
#include "tests/support/expect.h"
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
    return refusal_of<UserError>([&] { load(text); });
  }
};

}  // namespace wobblebench::testing_support
