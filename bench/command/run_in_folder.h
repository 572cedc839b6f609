// What every command that fills a folder does around its own work.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/command/common_options.h"
#include "bench/command/program.h"
#include "bench/output/document/document.h"
#include "bench/output/junit.h"
#include "bench/output/output_folder.h"
#include "bench/output/progress.h"

namespace wobblebench::bench {

/// A file in the folder that becomes a result and survives where the results cannot be written
/// (OutputFolder::adopt()).
struct AdoptedFile {
  std::filesystem::path path;
  std::string name;  ///< final
  std::string what;  ///< "the recording": the error of a failed write says where it is
};

/// What a command has found.
struct CommandResult {
  std::string report;   ///< text of report.json; empty: nothing is written, as by a part of a study
  std::string summary;  ///< printed on stdout, unless --json prints the report; empty: the document
  int exit_code = kDone;
  std::string failure;  ///< lines for stderr that say why the code is not kDone; empty: none
  std::optional<AdoptedFile> adopted = {};
  std::vector<Check> checks = {};  ///< for report.json, the page and --junit
  Document document = {};  ///< for report.html, NAME.md, and the files of its charts and tables
};

/// Adds it to the result's checks. Where it fails, its line to the result's failure, and exit code
/// kFailed.
void add_check(Check check, CommandResult& result);
/// Of --fail-on-loss. `what`: "sticks".
Check loss_check(std::uint64_t lost, std::uint64_t sent, const std::string& what = "sticks");
/// Of a command that checks the program itself. `what`: "seeds".
Check none_failed(const std::string& what, std::size_t failed);

/// Makes and locks the folder, runs `work`, which stages the command's files and times its steps,
/// adds report.json with its checks and what Progress::warn() said, the checks to the head of the
/// document, and the files of the document, gives the files their final names and prints the report
/// or its summary, and writes the checks to --junit. Returns the result's exit code. Whatever is
/// thrown leaves the folder as it was. `steps`: as Progress takes them.
int run_in_folder(const OutputArguments& output,
                  const std::vector<PlannedStep>& steps,
                  const std::function<CommandResult(OutputFolder&, Progress&)>& work);

}  // namespace wobblebench::bench
