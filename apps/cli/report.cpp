// pelage report: the pictures of many methods side by side, measured, as a page that needs no server.
#include <fmt/format.h>
#include <pelage/error.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "report/page.h"
#include "report/summary.h"
#include "terminal.h"
#include "verbs.h"

namespace pelage::cli {
namespace {

struct Options {
  std::string cases, folder, metric = "flip";
  std::vector<std::string> by;
  bool markdown = false, schema = false;
};

// One case at a time: the pictures of a report never stand in memory all at once.
std::vector<report::CaseNumbers> make(const report::Cases& cases, report::PageWriter* page) {
  ProgressLine line;
  const Progress progress = line.callback();
  std::vector<report::CaseNumbers> numbers;
  for (const report::Case& c : cases.cases) {
    if (!progress("report", static_cast<double>(numbers.size()) / static_cast<double>(cases.cases.size())))
      throw Error(cases.path, "", "cancelled", "");
    const report::MeasuredCase measured = report::measure(cases, c);
    if (page) page->add(measured);
    numbers.push_back(measured.numbers);
  }
  if (page) page->finish();
  return numbers;
}

void run(const Options& options) {
  const report::Cases cases = report::read_cases(options.cases);
  for (const std::string& axis : options.by) report::check_axis(cases, axis, options.metric);  // before the long work
  std::optional<report::PageWriter> page;
  if (!options.folder.empty()) page.emplace(cases, options.folder);
  const std::vector<report::CaseNumbers> numbers = make(cases, page ? &*page : nullptr);
  if (options.markdown) fmt::print("{}", report::summary_markdown(cases, numbers));
  const char* separator = options.markdown ? "\n" : "";
  for (const std::string& axis : options.by) {
    fmt::print("{}{}", separator, report::axis_markdown(cases, numbers, axis, options.metric));
    separator = "\n";
  }
  if (page)
    fmt::print(stderr, "{}/index.html: {} cases, {} methods\n", options.folder, cases.cases.size(), cases.methods.size());
}

}  // namespace

void add_report(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("report", "Compare the pictures of many methods on a page");
  const auto o = std::make_shared<Options>();
  verb->add_option("CASES", o->cases, "What to show (JSON; see --schema)")->type_name("FILE");
  verb->add_option("-o,--output", o->folder, "Folder to make; open its index.html in a browser")->type_name("DIR");
  verb->add_flag("--markdown", o->markdown, "Print the means over all cases as a table");
  verb->add_option("--by", o->by, "Print a metric of every method over the values of this axis; may be repeated")
      ->type_name("AXIS")
      ->allow_extra_args(false);
  verb->add_option("--metric", o->metric, "Metric of --by")->type_name("NAME")->capture_default_str();
  verb->add_flag("--schema", o->schema, "Print the JSON schema of CASES and stop");
  add_machine_options(*verb);
  verb->footer(
      "Examples:\n"
      "  pelage report cases.json -o report\n"
      "  pelage report cases.json --markdown --by hairstyle");
  verb->callback([o] {
    if (o->schema) return fmt::print("{}", report::cases_schema());
    if (o->cases.empty()) throw CLI::RequiredError("CASES");
    if (o->folder.empty() && !o->markdown && o->by.empty()) throw CLI::RequiredError("--output");
    run(*o);
  });
}

}  // namespace pelage::cli
