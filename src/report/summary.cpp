#include "report/summary.h"

#include <fmt/format.h>
#include <pelage/error.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/nearest.h"

namespace pelage::report {
namespace {

class Mean {
 public:
  void add(std::optional<double> x) {
    if (!x) return;
    sum_ += *x;
    ++count_;
  }
  std::optional<double> value() const { return count_ ? std::optional(sum_ / count_) : std::nullopt; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

using CaseFilter = std::function<bool(const Case&)>;

SummaryRow summarize(const Cases& cases, const std::vector<CaseNumbers>& numbers, const Method& method,
                     const CaseFilter& filter) {
  const std::size_t width = columns(cases).size();
  std::vector<Mean> hair(width), whole(width);
  Mean seconds;
  SummaryRow row{&method, 0, {}, {}, {}};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Case& c = cases.cases[i];
    if (!filter(c)) continue;
    for (std::size_t k = 0; k < c.images.size(); ++k) {
      if (c.images[k].method != method.name || c.reference == method.name) continue;
      const Measurement& m = numbers[i].entries[k];
      ++row.cases;
      if (c.images[k].seconds > 0) seconds.add(c.images[k].seconds);
      for (std::size_t j = 0; j < m.hair.size(); ++j) hair[j].add(m.hair[j]);
      for (std::size_t j = 0; j < m.whole.size(); ++j) whole[j].add(m.whole[j]);
    }
  }
  row.seconds = seconds.value();
  for (const Mean& mean : hair) row.hair.push_back(mean.value());
  for (const Mean& mean : whole) row.whole.push_back(mean.value());
  return row;
}

// Four significant digits, as few characters as tell them.
std::string shown(std::optional<double> x) {
  if (!x) return "–";
  if (std::isinf(*x)) return "∞";
  const double size = std::abs(*x);
  if (size != 0 && size < 1e-3) return fmt::format("{:.2e}", *x);
  return fmt::format("{:.{}f}", *x, size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 4);
}

// A column of cells with its best in bold, and what looks the same, unless all do; `higher` none: nothing is best.
std::vector<std::string> cells(const std::vector<std::optional<double>>& values, std::optional<bool> higher) {
  std::optional<double> best;
  std::multiset<std::string> looks;
  for (const std::optional<double>& x : values) {
    if (!x) continue;
    looks.insert(shown(x));
    if (higher && (!best || (*higher ? *x > *best : *x < *best))) best = x;
  }
  const bool all_alike = looks.size() > 1 && looks.count(shown(best)) == looks.size();
  const std::string marked = best && !all_alike ? shown(best) : "";
  std::vector<std::string> result;
  for (const std::optional<double>& x : values) result.push_back(shown(x) == marked ? fmt::format("**{}**", marked) : shown(x));
  return result;
}

std::string table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& body) {
  std::string text = "|";
  for (const std::string& cell : head) text += fmt::format(" {} |", cell);
  text += "\n|";
  for (std::size_t i = 0; i < head.size(); ++i) text += i == 0 ? "---|" : "---:|";
  for (std::size_t row = 0; row < body.front().size(); ++row) {
    text += "\n|";
    for (const std::vector<std::string>& column : body) text += fmt::format(" {} |", column[row]);
  }
  return text + "\n";
}

bool all_know_hair(const std::vector<CaseNumbers>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](const CaseNumbers& n) { return n.hair_pixels > 0; });
}

std::vector<std::string> labels(const std::vector<SummaryRow>& rows) {
  std::vector<std::string> result;
  for (const SummaryRow& row : rows) result.push_back(row.method->label);
  return result;
}

}  // namespace

std::vector<SummaryRow> summarize(const Cases& cases, const std::vector<CaseNumbers>& numbers) {
  std::vector<SummaryRow> rows;
  for (const Method& method : cases.methods) {
    SummaryRow row = summarize(cases, numbers, method, [](const Case&) { return true; });
    if (row.cases > 0) rows.push_back(std::move(row));
  }
  return rows;
}

std::string summary_markdown(const Cases& cases, const std::vector<CaseNumbers>& numbers) {
  const std::vector<SummaryRow> rows = summarize(cases, numbers);
  const std::vector<Column> metrics = columns(cases);
  const bool hair = all_know_hair(numbers);
  std::vector<std::string> head{"method"};
  std::vector<std::vector<std::string>> body{labels(rows)};
  const auto add = [&](const std::string& title, std::optional<bool> higher, const auto& number) {
    std::vector<std::optional<double>> values;
    for (const SummaryRow& row : rows) values.push_back(number(row));
    if (std::none_of(values.begin(), values.end(), [](const auto& x) { return x.has_value(); })) return;
    head.push_back(title);
    body.push_back(cells(values, higher));
  };
  for (std::size_t j = 0; j < metrics.size(); ++j)
    add(fmt::format("{} {}", metrics[j].label, metrics[j].higher_is_better ? "↑" : "↓"), metrics[j].higher_is_better,
        [&](const SummaryRow& row) { return (hair ? row.hair : row.whole)[j]; });
  add("seconds", std::nullopt, [](const SummaryRow& row) { return row.seconds; });
  return table(head, body);
}

namespace {

std::size_t require_name(const Cases& cases, const std::vector<std::string>& known, const std::string& name, const char* what) {
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end())
    throw Error(cases.path, "", fmt::format("no {} has the name `{}`", what, name),
                known.empty() ? "none is there" : fmt::format("did you mean `{}`?", nearest_name(name, known)));
  return static_cast<std::size_t>(found - known.begin());
}

std::size_t require_metric(const Cases& cases, const std::string& metric) {
  std::vector<std::string> keys;
  for (const Column& column : columns(cases)) keys.push_back(column.key);
  return require_name(cases, keys, metric, "metric");
}

}  // namespace

void check_axis(const Cases& cases, const std::string& axis, const std::string& metric) {
  require_name(cases, cases.axes, axis, "axis");
  require_metric(cases, metric);
}

std::string axis_markdown(const Cases& cases, const std::vector<CaseNumbers>& numbers, const std::string& axis,
                          const std::string& metric) {
  check_axis(cases, axis, metric);
  const std::vector<Column> metrics = columns(cases);
  const std::size_t j = require_metric(cases, metric);

  const auto place = [&](const Case& c) {
    const auto found = std::find_if(c.axes.begin(), c.axes.end(), [&](const AxisValue& v) { return v.axis == axis; });
    return found == c.axes.end() ? std::string() : found->text;
  };
  std::vector<std::string> head{fmt::format("{}, {}", metrics[j].label, axis)};
  const std::vector<SummaryRow> all = summarize(cases, numbers);
  std::vector<std::vector<std::string>> body{labels(all)};
  const bool hair = all_know_hair(numbers);
  for (const Case& c : cases.cases) {
    const std::string here = place(c);
    if (here.empty() || std::find(head.begin() + 1, head.end(), here) != head.end()) continue;
    std::vector<std::optional<double>> values;
    for (const SummaryRow& row : all) {
      const SummaryRow part = summarize(cases, numbers, *row.method, [&](const Case& other) { return place(other) == here; });
      values.push_back((hair ? part.hair : part.whole)[j]);
    }
    head.push_back(here);
    body.push_back(cells(values, metrics[j].higher_is_better));
  }
  return table(head, body);
}

}  // namespace pelage::report
