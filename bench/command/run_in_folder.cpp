#include "bench/command/run_in_folder.h"

#include <iostream>

namespace wobblebench::bench {

int run_in_folder(const OutputArguments& output,
                  const std::vector<PlannedStep>& steps,
                  const std::function<CommandResult(OutputFolder&, Progress&)>& work) {
  OutputFolder out(output.folder);
  Progress progress(steps);
  const CommandResult result = work(out, progress);
  out.write_text("report.json", result.report);
  out.commit();
  std::cout << (output.json ? result.report : result.summary);
  if (!result.failure.empty()) std::cerr << "wobblebench: " << result.failure << "\n";
  return result.exit_code;
}

}  // namespace wobblebench::bench
