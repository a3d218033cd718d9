#include <nlohmann/json.hpp>
#include <pelage/error.h>
#include <pelage/runtime.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <regex>

#include "bench.h"
#include "core/nearest.h"

namespace pelage::bench {
namespace {

constexpr int kLeastRuns = 5, kMostRuns = 101;
constexpr double kEnoughSeconds = 0.5;  // of timed work for one case, once it ran kLeastRuns times

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double median_absolute_deviation(std::vector<double> values) {
  const double center = median(values);
  for (double& v : values) v = std::fabs(v - center);
  return median(std::move(values));
}

void summarize(const std::vector<double>& values, Result& result) {
  result.value = median(values);
  result.mad = median_absolute_deviation(values);
  result.runs = static_cast<int>(values.size());
}

// Threads and instruction set for the life of the object.
class Conditions {
 public:
  explicit Conditions(const Side& side) : threads_(thread_count()), isa_(active_isa()) {
    if (side.threads) set_thread_count(side.threads);
    if (!side.isa.empty()) set_isa(side.isa);
  }
  ~Conditions() {
    if (thread_count() != threads_) set_thread_count(threads_);
    if (active_isa() != isa_) set_isa(isa_);
  }
  Conditions(const Conditions&) = delete;
  Conditions& operator=(const Conditions&) = delete;

 private:
  int threads_;
  std::string isa_;
};

double value_of(const Workload& work, double seconds) { return work.items > 0 ? work.items / seconds : seconds; }

// Fills everything but the measurement. False: skipped or wrong, and `result` says why.
bool prepare(const Case& c, Result& result, Workload& work) {
  result.threads = thread_count();
  result.isa = active_isa();
  try {
    work = c.prepare();
  } catch (const Skip& skip) {
    result.skipped = skip.reason;
    return false;
  }
  result.failed = work.check();
  result.checked = result.failed.empty();
  return result.checked;
}

Result measure(const Case& c) {
  Result result{.name = c.name, .metric = c.metric, .unit = c.unit};
  Workload work;
  if (!prepare(c, result, work)) return result;
  if (work.measure) {
    result.value = work.measure();
    result.runs = 1;
    if (!std::isfinite(result.value)) result.failed = "the measured value is not finite";
    return result;
  }
  work.run();
  std::vector<double> values;
  for (double spent = 0; values.size() < kLeastRuns || (spent < kEnoughSeconds && values.size() < kMostRuns);) {
    const double seconds = seconds_of(work.run);
    spent += seconds;
    values.push_back(value_of(work, seconds));
  }
  summarize(values, result);
  return result;
}

const Case& find_case(const Suite& suite, const std::string& name) {
  for (const Case& c : suite.cases)
    if (c.name == name) return c;
  throw Error("bench", name, "a ratio names a case that does not exist", "");
}

Result measure(const Suite& suite, const Ratio& ratio) {
  Result result{.name = ratio.name, .metric = "ratio", .unit = "1"};
  Workload over, under;
  const auto ready = [&](const Side& side, Workload& work) {
    const Conditions conditions(side);
    return prepare(find_case(suite, side.name), result, work);
  };
  if (!ready(ratio.under, under) || !ready(ratio.over, over)) return result;
  const auto timed = [](const Side& side, const Workload& work) {
    const Conditions conditions(side);
    return value_of(work, seconds_of(work.run));
  };
  timed(ratio.under, under), timed(ratio.over, over);  // warm-up
  std::vector<double> values;
  const auto start = std::chrono::steady_clock::now();
  const auto enough = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > 2 * kEnoughSeconds;
  };
  while (values.size() < kLeastRuns || (!enough() && values.size() < kMostRuns)) {
    const double below = timed(ratio.under, under);
    values.push_back(timed(ratio.over, over) / below);
  }
  summarize(values, result);
  return result;
}

}  // namespace

void run(const Suite& suite, const std::string& pattern, const std::function<void(const Result&)>& report) {
  std::regex expression;
  try {
    expression = std::regex(pattern, std::regex::ECMAScript);
  } catch (const std::regex_error& e) {
    throw Error("bench", pattern, e.what(), "give an ECMAScript regular expression");
  }
  bool any = false;
  for (const Case& c : suite.cases)
    if (std::regex_search(c.name, expression)) report(measure(c)), any = true;
  for (const Ratio& r : suite.ratios)
    if (std::regex_search(r.name, expression)) report(measure(suite, r)), any = true;
  if (any) return;
  std::vector<std::string> names;
  for (const Case& c : suite.cases) names.push_back(c.name);
  for (const Ratio& r : suite.ratios) names.push_back(r.name);
  throw Error("bench", pattern, "no case has such a name", "nearest: " + nearest_name(pattern, names) + "; see --list");
}

std::string to_json(const Result& r) {
  nlohmann::ordered_json j{{"case", r.name}, {"metric", r.metric}};
  if (!r.skipped.empty()) j["skipped"] = r.skipped;
  else if (!r.failed.empty()) j["failed"] = r.failed;
  else j.update({{"value", r.value}, {"unit", r.unit}, {"runs", r.runs}, {"mad", r.mad}});
  j["threads"] = r.threads;
  j["isa"] = r.isa;
  j["checked"] = r.checked;
  return j.dump();
}

}  // namespace pelage::bench
