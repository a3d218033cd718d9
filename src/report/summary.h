// A report in a few rows: means over its cases.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/cases.h"
#include "report/measure.h"

namespace pelage::report {

struct SummaryRow {
  const Method* method;
  std::size_t cases = 0;          ///< over which the means are taken
  std::optional<double> seconds;  ///< mean; none where no case tells it
  Numbers hair, whole;            ///< means; a number that a case lacks is left out of the mean
};

/// One row a method that is measured in at least one case, in the order of `cases.methods`.
std::vector<SummaryRow> summarize(const Cases& cases, const std::vector<CaseNumbers>& numbers);

/// The rows as a table in Markdown, on hair pixels where every case knows them; the best of each column is bold.
std::string summary_markdown(const Cases& cases, const std::vector<CaseNumbers>& numbers);

/// Throws Error where `cases` has no such axis or metric, naming the nearest: to know before anything is measured.
void check_axis(const Cases& cases, const std::string& axis, const std::string& metric);

/// One metric of the methods (rows) over the values of an axis (columns). Throws as check_axis().
std::string axis_markdown(const Cases& cases, const std::vector<CaseNumbers>& numbers, const std::string& axis,
                          const std::string& metric);

}  // namespace pelage::report
