// Every type of exception that may reach a user: one line that says what is wrong, and whose it is.
#include "bench/command/program.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "base/options.h"
#include "base/user_error.h"
#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

template <class Exception>
void expect_refusal(const Exception& exception, int code, const std::string& line) {
  const Refusal refusal = refusal_of(std::make_exception_ptr(exception));
  EXPECT_EQ(refusal.code, code) << refusal.line;
  EXPECT_EQ(refusal.line, line);
}

TEST(Refusals, EachTypeOfExceptionHasALine) {
  const auto denied = std::make_error_code(std::errc::permission_denied);
  expect_refusal(UserError("x: y"), kBadInput, "x: y");
  expect_refusal(InvalidOption("x", "3", "must be 4"), kBadInput, "x = 3: must be 4");
  expect_refusal(std::bad_alloc(), kFailed, "out of memory");
  expect_refusal(std::filesystem::filesystem_error("status", "/a/b", denied),
                 kFailed,
                 "/a/b: cannot be used: Permission denied");
  expect_refusal(std::system_error(denied, "/a/lock"), kFailed, "/a/lock: Permission denied");
  expect_refusal(std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again)),
                 kFailed,
                 "the system refuses a thread, a lock or memory: Resource temporarily unavailable");
  expect_refusal(std::runtime_error("a disk"), kFailed, "a disk");
  const std::string internal = "a fault of this program, please report it: ";
  expect_refusal(std::out_of_range("index 3"), kFailed, internal + "index 3");
  expect_refusal(std::exception(), kFailed, internal + "std::exception");
  struct OpenCvException : std::exception {
    const char* what() const noexcept override {
      return "OpenCV(4.6.0) alloc.cpp:73: error: (-4:Insufficient memory) Failed to allocate 9 "
             "bytes";
    }
  };
  expect_refusal(OpenCvException(), kFailed, "out of memory");
  expect_refusal(42, kFailed, internal + "an exception without a text");
}

}  // namespace
}  // namespace wobblebench::bench
