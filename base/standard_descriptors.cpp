#include "base/standard_descriptors.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace wobblebench {

void occupy_standard_descriptors() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(number, F_GETFD) >= 0) continue;
    // The wrong way round, so that use of the stream is an error, as it is when it is closed.
    const int flags = number == STDIN_FILENO ? O_WRONLY : O_RDONLY;
    // The lowest free number is this one, as those below are open.
    if (::open("/dev/null", flags) != number) {
      throw std::system_error(errno, std::generic_category(), "/dev/null");
    }
  }
}

}  // namespace wobblebench
