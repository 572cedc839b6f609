#include "bench/command/run_in_folder.h"

#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "bench/command/open_in_browser.h"
#include "bench/output/finished_report.h"
#include "bench/output/page/report_page.h"

namespace wobblebench::bench {

namespace {

/// NAME.md, tables and charts as files of their own, and the page that shows all of it.
void stage_document(OutputFolder& out, const CommandResult& result) {
  const Document& document = result.document;
  if (!document.name.empty()) out.write_text(document.name + ".md", markdown(document));
  for (const DataFile& data : document.data) out.write_text(data.file, csv(data.table));
  for (const Block& block : document.blocks) {
    const auto* figure = std::get_if<Figure>(&block);
    if (figure == nullptr) continue;
    out.write_text(chart_file(document, *figure), specification(*figure).dump(1) + "\n");
  }
  const auto read_picture = [&](const std::string& file) { return out.read_staged(file); };
  out.write_text("report.html", report_page(document, result.report, command_line(), read_picture));
}

/// All files get their names, or none does.
void commit(OutputFolder& out, const CommandResult& result) {
  const auto& adopted = result.adopted;
  try {
    if (adopted) out.adopt(adopted->path, adopted->name);
    stage_document(out, result);
    out.write_text("report.json", result.report);
    out.commit();
  } catch (const std::exception& error) {
    if (!adopted) throw;
    throw std::runtime_error(std::string(error.what()) + "; " + adopted->what + " is " +
                             adopted->path.string());
  }
}

std::string summary_of(const CommandResult& result) {
  return result.summary.empty() ? markdown(result.document) : result.summary;
}

}  // namespace

int run_in_folder(const OutputArguments& output,
                  const std::vector<PlannedStep>& steps,
                  const std::function<CommandResult(OutputFolder&, Progress&)>& work) {
  OutputFolder out(output.folder);
  Progress progress(steps);
  CommandResult result = work(out, progress);
  if (result.report.empty()) {
    // There is no report to say it.
    progress.warn(progress.machine_use().warning());
    if (output.open) progress.warn("--open: without effect: there is no report yet");
    std::cout << result.summary;
    return result.exit_code;
  }
  result.report = finished_report(result.report, progress);
  commit(out, result);
  if (output.open) progress.warn(open_in_browser(output.folder / "report.html"));
  std::cout << (output.json ? result.report : summary_of(result));
  if (!result.failure.empty()) std::cerr << "wobblebench: " << result.failure << "\n";
  return result.exit_code;
}

}  // namespace wobblebench::bench
