// CASES.json: what a report shows. Schema: docs/report.schema.json, made from the same tables as the reader.
#pragma once

#include <pelage/scene.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pelage::report {

/// A way of making pictures, told once for all cases.
struct Method {
  std::string name;    ///< as images name it
  std::string label;   ///< as the page shows it; the name where the file gives none
  std::string series;  ///< methods of one series are joined by a line in plots; the label where the file gives none
  std::string about;   ///< a sentence; may be empty
};

/// One picture of a case. Unknown numbers are 0.
struct Entry {
  std::string method, file, command;
  float seconds = 0;
  int samples = 0;                                     ///< per pixel
  std::vector<std::pair<std::string, double>> values;  ///< numbers that were measured elsewhere, by name
};

/// Where a case stands on an axis: a word, or a number that plots can use.
struct AxisValue {
  std::string axis, text;
  std::optional<double> number;
};

/// The same scene by several methods.
struct Case {
  std::string title, about;
  std::string reference;  ///< the method that the others are measured against
  std::string mask;       ///< file whose first channel tells the hair pixels; empty: see Measured::hair_pixels
  std::vector<AxisValue> axes;
  std::vector<std::pair<std::string, std::string>> settings;
  std::vector<Entry> images;
};

/// A number of Entry::values that is told as a metric.
struct ExtraMetric {
  enum class Better { kLower, kHigher };
  std::string name, about;
  Better better = Better::kLower;
};

/// The whole file. Every image names a known method, every case a reference among its own images, and no name occurs
/// twice where it must be unique.
struct Cases {
  std::string path, schema, title = "Report", about, machine, reference;
  std::optional<ToneMap> tone_map;  ///< absent: ACES for scene-linear files, none for display-encoded ones
  float exposure = 0;               ///< stops
  std::vector<std::string> axes;    ///< in the order of the page
  std::vector<Method> methods;
  std::vector<ExtraMetric> values;
  std::vector<Case> cases;

  std::string file(const std::string& name) const;  ///< as found from the folder of CASES.json
};

/// Throws Error naming the line and key, and for an unknown key or name the nearest known one.
Cases read_cases(const std::string& path);

std::string cases_schema();

}  // namespace pelage::report
