// A report as a folder: index.html, pixels beside it, and nothing from anywhere else.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

#include "report/cases.h"
#include "report/measure.h"

namespace pelage::report {

/// A folder that appears whole or not at all: everything goes to a temporary folder beside it until commit().
class ReportFolder {
 public:
  /// Throws Error where something stands at `path` that is no report (a file, a folder with other things), which commit()
  /// would replace.
  explicit ReportFolder(const std::string& path);
  ReportFolder(const ReportFolder&) = delete;
  ReportFolder& operator=(const ReportFolder&) = delete;
  ~ReportFolder();

  std::string file(const std::string& name) const { return (temporary_ / name).string(); }
  void commit();

 private:
  std::filesystem::path path_, temporary_;
};

/// Writes one. add() every case in the order of `cases`, then finish().
class PageWriter {
 public:
  PageWriter(const Cases& cases, const std::string& folder);
  void add(const MeasuredCase& measured);
  void finish();

 private:
  std::string add_thumbnail(const Image& linear, ToneMap curve, const std::string& name);
  std::string add_error_thumbnail(const Image& error, const std::string& name);

  const Cases& cases_;
  const std::vector<Column> columns_;
  ReportFolder folder_;
  nlohmann::ordered_json case_list_ = nlohmann::ordered_json::array();
};

/// `json` as text that may stand in a script element of HTML whatever its strings hold.
std::string script_safe(const nlohmann::ordered_json& json);

/// `text` as HTML text or attribute.
std::string html_escaped(const std::string& text);

}  // namespace pelage::report
