// Line diagrams as SVG, side by side.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <pelage/vec.h>

namespace pelage::plots {

inline constexpr const char* kColors[] = {"#1b6ca8", "#c0392b", "#27864b", "#8e6c1f"};

// One diagram: x and y of the data to a box of the page.
class Diagram {
 public:
  Diagram(double left, double top, double x_max, double y_max, const std::string& title, const std::string& x_title)
      : left_(left), top_(top), x_max_(x_max), y_max_(y_max) {
    out_ += fmt::format("<rect x='{}' y='{}' width='{}' height='{}' fill='none' stroke='#999'/>\n", left, top, kWidth, kHeight);
    text(left + kWidth / 2, top - 8, title, "middle");
    text(left + kWidth / 2, top + kHeight + 30, x_title, "middle");
    for (int i = 0; i <= 4; ++i) {
      text(left + kWidth * i / 4, top + kHeight + 15, fmt::format("{:g}", x_max * i / 4), "middle");
      text(left - 5, top + kHeight * (4 - i) / 4 + 4, fmt::format("{:g}", y_max * i / 4), "end");
    }
  }
  void line(const std::vector<Vec2>& points, const std::string& color, const std::string& dash = "") {
    out_ += fmt::format("<polyline fill='none' stroke='{}' stroke-width='1.5' stroke-dasharray='{}' points='", color, dash);
    for (const Vec2& p : points) out_ += fmt::format("{:.1f},{:.1f} ", at_x(p.x), at_y(p.y));
    out_ += "'/>\n";
  }
  void dots(const std::vector<Vec2>& points, const std::string& color) {
    for (const Vec2& p : points)
      out_ += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='2' fill='{}'/>\n", at_x(p.x), at_y(p.y), color);
  }
  void label(int row, const std::string& what, const std::string& color, bool at_left = false) {
    out_ += fmt::format("<text x='{}' y='{}' fill='{}'>{}</text>\n", left_ + (at_left ? 12 : kWidth - 150),
                        top_ + 18 + 15 * row, color, what);
  }
  const std::string& svg() const { return out_; }

  static constexpr double kWidth = 360, kHeight = 240;

 private:
  double at_x(double x) const { return left_ + kWidth * x / x_max_; }
  double at_y(double y) const { return top_ + kHeight * (1 - std::fmin(y / y_max_, 1)); }
  void text(double x, double y, const std::string& what, const char* anchor) {
    out_ += fmt::format("<text x='{}' y='{}' text-anchor='{}'>{}</text>\n", x, y, anchor, what);
  }
  double left_, top_, x_max_, y_max_;
  std::string out_;
};

inline void write(const std::string& path, const std::vector<Diagram>& diagrams) {
  const double width = 450. * static_cast<double>(diagrams.size());
  std::ofstream out(path);
  out << fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='310' font-family='sans-serif' font-size='11'>\n"
      "<rect width='{0}' height='310' fill='white'/>\n",
      width);
  for (const Diagram& d : diagrams) out << d.svg();
  out << "</svg>\n";
}

}  // namespace pelage::plots
