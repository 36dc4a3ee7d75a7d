#include "tests/verify/support/figures_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace touchtrace::report {
namespace {

constexpr double width = 640, height = 360, left = 80, right = 170, top = 20, bottom = 50;
constexpr std::array colors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                            "#e69f00", "#56b4e9", "#555555"};

std::string escaped(const std::string& text) {
  std::string result;
  for (char c : text) switch (c) {
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  return result;
}

/// Maps values to pixels along one axis.
struct Axis {
  bool logarithmic;
  double first_pixel, last_pixel;
  double low = std::numeric_limits<double>::infinity(), high = -low;

  bool can_show(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
  double scaled(double value) const { return logarithmic ? std::log10(value) : value; }
  void include(double value) {
    if (!can_show(value)) return;
    low = std::min(low, scaled(value)), high = std::max(high, scaled(value));
  }
  void widen() {
    if (!(low <= high)) low = 0, high = 1;
    const double margin = high > low ? 0.05 * (high - low) : 0.5;
    low -= margin, high += margin;
  }
  double pixel(double value) const {
    return first_pixel + (last_pixel - first_pixel) * (scaled(value) - low) / (high - low);
  }
  std::vector<double> ticks() const {
    const double rough = (high - low) / 5, power = std::pow(10.0, std::floor(std::log10(rough)));
    const double step = power * (rough / power < 2 ? 1 : rough / power < 5 ? 2 : 5);
    std::vector<double> values;
    for (double t = std::ceil(low / step) * step; t <= high; t += step)
      values.push_back(logarithmic ? std::pow(10.0, t) : std::abs(t) < 1e-9 * step ? 0.0 : t);
    return values;
  }
};

std::string line(double x1, double y1, double x2, double y2) {
  return fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' stroke='#ddd'/>", x1,
                     y1, x2, y2);
}

std::string label(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>", x, y, anchor,
                     escaped(text));
}

std::string axes_svg(const Picture& picture, const Axis& x, const Axis& y) {
  std::string svg;
  for (double t : x.ticks())
    svg += line(x.pixel(t), top, x.pixel(t), height - bottom) +
           label(x.pixel(t), height - bottom + 16, "middle", fmt::format("{:.3g}", t));
  for (double t : y.ticks())
    svg += line(left, y.pixel(t), width - right, y.pixel(t)) +
           label(left - 6, y.pixel(t) + 4, "end", fmt::format("{:.3g}", t));
  svg += label((left + width - right) / 2, height - 12, "middle", picture.x_label);
  return svg +
         fmt::format(
             "<text transform='translate(16,{:.0f}) rotate(-90)' text-anchor='middle'>{}</text>",
             (top + height - bottom) / 2, escaped(picture.y_label));
}

std::string curve_svg(const Picture::Curve& curve, std::size_t number, const Axis& x,
                      const Axis& y) {
  const char* color = colors[number % colors.size()];
  std::string points, dots;
  for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
    if (!x.can_show(curve.x[i]) || !y.can_show(curve.y[i])) continue;
    const double px = x.pixel(curve.x[i]), py = y.pixel(curve.y[i]);
    points += fmt::format("{:.1f},{:.1f} ", px, py);
    dots += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='2.5' fill='{}'/>", px, py, color);
  }
  const double legend_y = top + 14 + 18 * static_cast<double>(number);
  return fmt::format("<polyline points='{}' fill='none' stroke='{}' stroke-width='1.5'/>", points,
                     color) +
         dots +
         fmt::format("<rect x='{:.0f}' y='{:.0f}' width='12' height='4' fill='{}'/>",
                     width - right + 12, legend_y - 6, color) +
         label(width - right + 30, legend_y, "start", curve.name);
}

std::string row_html(const Figure& figure) {
  return fmt::format(
      "<tr><td>{}</td><td class='n'>{:.6g}</td><td>{}</td><td>{}</td><td class='{}'>{}</td>"
      "<td class='n'>{:.2f}</td></tr>\n",
      escaped(figure.name), figure.value, escaped(figure.unit), escaped(figure.goal_text()),
      figure.passes() ? "pass" : "fail", figure.passes() ? "PASS" : "FAIL", figure.seconds);
}

constexpr const char* style =
    "body{font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 "
    "1rem;color:#222}"
    "table{border-collapse:collapse}td,th{padding:.2rem .8rem;border-bottom:1px solid "
    "#ddd;text-align:left}"
    ".n{text-align:right;font-variant-numeric:tabular-nums}.fail{color:#b00020;font-weight:600}"
    "svg{font-size:11px;max-width:100%}";

}  // namespace

std::string to_svg(const Picture& picture) {
  Axis x{picture.log_x, left, width - right}, y{picture.log_y, height - bottom, top};
  for (const auto& curve : picture.curves) {
    for (double value : curve.x) x.include(value);
    for (double value : curve.y) y.include(value);
  }
  x.widen(), y.widen();
  std::string svg =
      fmt::format("<svg viewBox='0 0 {} {}' width='{}' height='{}'>", width, height, width, height);
  svg += axes_svg(picture, x, y);
  for (std::size_t i = 0; i < picture.curves.size(); ++i)
    svg += curve_svg(picture.curves[i], i, x, y);
  return svg + "</svg>";
}

std::string figures_page(const std::string& title, const std::vector<Figure>& figures) {
  std::string page = fmt::format(
      "<!doctype html><html lang='en'><meta charset='utf-8'><title>{0}</title><style>{1}</style>"
      "<h1>{0}</h1>\n<table><tr><th>figure<th>value<th>unit<th>goal<th><th>seconds</tr>\n",
      escaped(title), style);
  for (const auto& figure : figures) page += row_html(figure);
  page += "</table>\n";
  for (const auto& figure : figures)
    if (figure.picture)
      page += fmt::format("<h2>{}</h2>\n{}\n", escaped(figure.name), to_svg(*figure.picture));
  return page + "</html>\n";
}

}  // namespace touchtrace::report
