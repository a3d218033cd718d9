// `pelage bench`: named cases that check their answer against a slow, obvious reference and are timed after that.
//
// A file bench/<stage>.cpp defines `void add_<stage>_cases(Suite&)`, is named in bench/CMakeLists.txt and called by
// all_cases() in bench/suite.cpp:
//
//   suite.cases.push_back({"raster.center.curly50k", "segments_per_second", "1/s", [] {
//     auto input = std::make_shared<…>(…);          // set-up, not timed
//     return Workload{.check = [input] { return reference(*input) == fast(*input) ? "" : "keys differ"; },
//                     .run = [input] { fast(*input); },
//                     .items = segments};
//   }});
//   suite.ratios.push_back({"raster.speedup.curly50k", {"raster.center.curly50k"}, {"raster.naive.curly50k"}});
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace pelage::bench {

/// A case made ready. Exactly one of `run` and `measure` is set.
struct Workload {
  std::function<std::string()> check = {};  ///< says what is wrong with the answer, "" when it is right; required
  std::function<void()> run = {};           ///< timed: the value is items ÷ seconds, or seconds where items is 0
  double items = 0;                         ///< what one run works on, in the metric's terms
  std::function<double()> measure = {};     ///< not timed: the value itself (an error, an energy, bytes)
};

struct Case {
  std::string name;                   ///< stage.case.input; stable, others rely on it
  std::string metric;                 ///< e.g. "segments_per_second", "seconds_per_frame", "mean_absolute_error"
  std::string unit;                   ///< "1/s", "s", "1", "B"
  std::function<Workload()> prepare;  ///< may throw Skip
};

/// A case under chosen conditions; 0 and "" keep those of the command line.
struct Side {
  std::string name;
  int threads = 0;
  std::string isa = {};
};

/// Value of one case over the value of another, measured in turns in the same run so that the machine's moods cancel.
struct Ratio {
  std::string name;
  Side over, under;
};

struct Suite {
  std::vector<Case> cases;
  std::vector<Ratio> ratios;
};

/// Thrown by prepare() where an input is missing: the case is reported as skipped, with the reason.
struct Skip {
  std::string reason;
};

/// One line of the report.
struct Result {
  std::string name, metric, unit;
  double value = 0;  ///< median
  double mad = 0;    ///< median absolute deviation from it
  int runs = 0;      ///< after one warm-up
  int threads = 0;
  std::string isa = {};
  bool checked = false;
  std::string skipped = {};  ///< reason; nothing was measured then
  std::string failed = {};   ///< what check() said; nothing was measured then
};

/// Every case of the program, in the order of the stages.
Suite all_cases();

/// Measures the cases and ratios whose name contains a match of `pattern` (ECMAScript), calling `report` after each.
/// A ratio checks and measures its two cases itself. Throws Error on a bad pattern or one that matches nothing.
void run(const Suite& suite, const std::string& pattern, const std::function<void(const Result&)>& report);

/// {"case":…,"metric":…,"value":…,"unit":…,"runs":…,"mad":…,"threads":…,"isa":…,"checked":…} in one line.
std::string to_json(const Result& result);

}  // namespace pelage::bench
