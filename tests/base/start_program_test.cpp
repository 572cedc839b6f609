// A program gets the descriptors that it is given, and no others; and signals of its own.
#include "base/start_program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "base/file.h"

namespace wobblebench {
namespace {

int exit_code_of(const std::string& script, Session session) {
  pid_t child = 0;
  int status = 0;
  EXPECT_EQ(start_program(child, {"sh", "-c", script}, {-1, -1, -1}, session), 0);
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return WEXITSTATUS(status);
}

TEST(StartProgram, InheritsNoDescriptorThatALibraryLeftOpen) {
  const FileDescriptor open(::open("/dev/null", O_RDONLY));  // as an exec() keeps it
  const std::string path = "/proc/self/fd/" + std::to_string(open.get());
  EXPECT_EQ(exit_code_of("test ! -e " + path + " && test -e /proc/self/fd/2", Session::shared), 0);
}

TEST(StartProgram, HasASessionAndWithItAGroupOfItsOwn) {
  const std::string leads = "set -- $(cat /proc/$$/stat); test $5 = $$ && test $6 = $$";
  EXPECT_EQ(exit_code_of(leads, Session::own), 0);
  EXPECT_EQ(exit_code_of(leads, Session::shared), 1);
}

TEST(StartProgram, SaysWhatIsNotThere) {
  pid_t child = 0;
  EXPECT_EQ(start_program(child, {"no-such-program"}, {}, Session::shared), ENOENT);
}

}  // namespace
}  // namespace wobblebench
