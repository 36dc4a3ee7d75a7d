#include "engine/base/parabola.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchtrace {
namespace {

TEST(Parabola, VertexOfASampledQuadratic) {
  const auto f = [](double x) { return 3.0 * (x - 0.3) * (x - 0.3) - 2.0; };
  EXPECT_NEAR(parabola_vertex(f(-1.0), f(0.0), f(1.0)), 0.3, 1e-15);
}

TEST(Parabola, CollinearPointsHaveNoVertex) {
  EXPECT_FALSE(std::isfinite(parabola_vertex(1.0, 2.0, 3.0)));
  EXPECT_FALSE(std::isfinite(parabola_vertex(1.0, 1.0, 1.0)));
}

}  // namespace
}  // namespace touchtrace
