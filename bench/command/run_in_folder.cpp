#include "bench/command/run_in_folder.h"

#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "base/file.h"
#include "base/user_error.h"
#include "bench/command/open_in_browser.h"
#include "bench/output/encoders.h"
#include "bench/output/finished_report.h"
#include "bench/output/page/report_page.h"

namespace wobblebench::bench {

namespace {

/// A picture for the page. A large one is compressed, so that the page stays below 3 MB.
std::string page_picture(const OutputFolder& out, const std::string& file) {
  constexpr std::size_t kLarge = 300'000;
  constexpr int kMostSide = 1024;
  const std::string png = out.read_staged(file);
  return png.size() <= kLarge ? png : encoders().compress(png, kMostSide);
}

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
  const auto read_picture = [&](const std::string& file) { return page_picture(out, file); };
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

namespace fs = std::filesystem;

/// Refuses, before the work, a file that could not be written after it, or is another result.
void check_junit(const fs::path& junit) {
  if (junit.empty()) return;
  const std::string option = "--junit = " + junit.string();
  if (junit.extension() != ".xml")
    throw UserError(option + ": must be the name of a file, NAME.xml");
  const fs::path folder = junit.has_parent_path() ? junit.parent_path() : ".";
  if (!fs::is_directory(folder)) throw UserError(option + ": its folder does not exist");
  if (fs::exists(junit) && !fs::is_regular_file(junit)) throw UserError(option + ": is no file");
}

/// The whole file under its name, or none.
void write_junit(const fs::path& junit, const std::vector<Check>& checks) {
  if (junit.empty()) return;
  fs::path partial = junit;
  partial += ".partial";
  write_file(partial, junit_xml("wobblebench", checks));
  fs::rename(partial, junit);
}

void lead_with(const std::string& verdict, Document& document) {
  if (!verdict.empty()) document.blocks.insert(document.blocks.begin(), Text{verdict});
}

void print_lines(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) std::cerr << "wobblebench: " << line << "\n";
}

}  // namespace

void add_check(Check check, CommandResult& result) {
  if (!check.failure.empty()) {
    result.exit_code = kFailed;
    result.failure += (result.failure.empty() ? "" : "\n") + check.line();
  }
  result.checks.push_back(std::move(check));
}

Check loss_check(std::uint64_t lost, std::uint64_t sent, const std::string& what) {
  return {.group = "stream",
          .name = "no stick is lost",
          .failure = lost == 0 ? ""
                               : std::to_string(lost) + " of " + std::to_string(sent) + " " + what +
                                     " were lost",
          .asked = "--fail-on-loss",
          .limit = 0,
          .value = static_cast<double>(lost)};
}

Check none_failed(const std::string& what, std::size_t failed) {
  return {.group = what,
          .name = "none failed",
          .failure = failed == 0 ? "" : std::to_string(failed) + " " + what + " failed",
          .limit = 0,
          .value = static_cast<double>(failed)};
}

int run_in_folder(const OutputArguments& output,
                  const std::vector<PlannedStep>& steps,
                  const std::function<CommandResult(OutputFolder&, Progress&)>& work) {
  OutputFolder out(output.folder);
  check_junit(output.junit);
  Progress progress(steps);
  progress.warn(out.warning());
  CommandResult result = work(out, progress);
  if (result.report.empty()) {
    // There is no report to say it.
    progress.warn(progress.machine_use().warning());
    if (output.open) progress.warn("--open: without effect: there is no report yet");
    std::cout << result.summary;
    return result.exit_code;
  }
  result.report = finished_report(result.report, result.checks, progress);
  lead_with(verdict_text(result.checks), result.document);
  commit(out, result);
  write_junit(output.junit, result.checks);
  if (output.open) progress.warn(open_in_browser(output.folder / "report.html"));
  std::cout << (output.json ? result.report : summary_of(result));
  print_lines(result.failure);
  return result.exit_code;
}

}  // namespace wobblebench::bench
