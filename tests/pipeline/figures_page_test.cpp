#include "tests/verify/support/figures_page.h"

#include <gtest/gtest.h>

#include <limits>

namespace touchtrace::report {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(FiguresPage, DrawsFinitePointsOnly) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Picture picture{"seconds", "error", true, true, {{"a", {1, 10, -1, nan}, {1, 2, 3, 4}}}};
  EXPECT_EQ(count(to_svg(picture), "<circle"), 2u);
  EXPECT_EQ(count(to_svg({"x", "y", false, false, {}}), "nan"), 0u);
}

TEST(FiguresPage, ShowsRowsAndEscapes) {
  Figure good = at_most("rms of <left>", 0.2, "px", 0.24);
  good.picture = Picture{"s", "px", false, false, {{"one", {0, 1}, {1, 0}}}};
  const auto page = figures_page("calibration", {good, at_least("speed", 1.0, "x", 2.0)});
  EXPECT_NE(page.find("rms of &lt;left&gt;"), std::string::npos);
  EXPECT_EQ(count(page, ">FAIL<"), 1u);
  EXPECT_EQ(count(page, "<svg"), 1u);
  EXPECT_EQ(count(page, "http"), 0u);
}

}  // namespace
}  // namespace touchtrace::report
