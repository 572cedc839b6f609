#include "bench/cli/recording_folder.h"

#include "base/user_error.h"
#include "bench/cli/record_report.h"

namespace wobblebench::bench {

namespace fs = std::filesystem;

fs::path new_partial(const OutputFolder& out, bool replace, bool with_iq) {
  const fs::path whole = out.directory() / kRecordingName;
  fs::path partial = whole.string() + ".partial";
  const auto refuse = [&](const std::string& what) {
    throw UserError("--out = " + out.directory().string() + ": holds " + what);
  };
  const auto holds = [](const fs::path& path) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored));
  };
  std::error_code ignored;
  // A command was killed after its recording had its final name, before it lost the other.
  if (fs::equivalent(partial, whole, ignored)) fs::remove(partial);
  if (holds(partial)) {
    refuse(
        "a recording that was not finished; must be a folder without one (`wobblebench inspect " +
        partial.string() + " --salvage NEW` copies what it holds)");
  }
  if (!replace && holds(whole)) {
    refuse(std::string(kRecordingName) +
           "; must be a folder without one, unless --replace is given");
  }
  if (!(replace && with_iq) && holds(out.directory() / kIqName)) {
    refuse(std::string(kIqName) +
           " of another recording; must be a folder without one, unless --replace and --iq are "
           "given");
  }
  return partial;
}

}  // namespace wobblebench::bench
