#include "import_options.h"

#include <fmt/format.h>

#include <map>

namespace pelage::cli {

void add_import_options(CLI::App& verb, ImportOptions& options) {
  static const std::map<std::string, UpAxis> axes = {{"auto", UpAxis::kAuto}, {"y", UpAxis::kY}, {"z", UpAxis::kZ}};
  verb.add_option("--scale", options.scale, "Meters per unit of the file (0.01 for centimeters); guessed if not given")
      ->check(CLI::PositiveNumber)
      ->type_name("M");
  const auto set_up = [&options](const std::string& name) { options.up = axes.at(name); };
  verb.add_option_function<std::string>("--up", set_up, "Axis of the file that points up: y, z or auto")
      ->transform(CLI::IsMember({"auto", "y", "z"}, CLI::ignore_case))
      ->type_name("AXIS");
  verb.add_option("--width", options.default_width,
                  "Meters, diameter of strands whose file has no widths; guessed if not given")
      ->check(CLI::PositiveNumber)
      ->type_name("M");
}

std::string import_summary(const ImportReport& report) {
  std::string text;
  for (const std::string& note : report.notes) text += fmt::format("  {}\n", note);
  if (!report.repairs.clean()) text += fmt::format("  repaired: {}\n", report.repairs.summary());
  return text;
}

}  // namespace pelage::cli
