#include "bench/command/run_in_folder.h"

#include <iostream>
#include <stdexcept>

#include "bench/output/finished_report.h"

namespace wobblebench::bench {

namespace {

/// All files get their names, or none does.
void commit(OutputFolder& out, const CommandResult& result) {
  const auto& adopted = result.adopted;
  try {
    if (adopted) out.adopt(adopted->path, adopted->name);
    out.write_text("report.json", result.report);
    out.commit();
  } catch (const std::exception& error) {
    if (!adopted) throw;
    throw std::runtime_error(std::string(error.what()) + "; " + adopted->what + " is " +
                             adopted->path.string());
  }
}

}  // namespace

int run_in_folder(const OutputArguments& output,
                  const std::vector<PlannedStep>& steps,
                  const std::function<CommandResult(OutputFolder&, Progress&)>& work) {
  OutputFolder out(output.folder);
  Progress progress(steps);
  CommandResult result = work(out, progress);
  result.report = finished_report(result.report, progress);
  commit(out, result);
  std::cout << (output.json ? result.report : result.summary);
  if (!result.failure.empty()) std::cerr << "wobblebench: " << result.failure << "\n";
  return result.exit_code;
}

}  // namespace wobblebench::bench
