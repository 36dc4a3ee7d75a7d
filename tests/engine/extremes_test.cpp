#include <gtest/gtest.h>

#include "tests/verify/engine/verify_engine.h"

namespace touchtrace {
namespace {

TEST(Extremes, EveryFigureMeetsItsGoal) {
  verify_extremes([](const Figure& figure) {
    EXPECT_TRUE(figure.passes()) << figure.name << ": " << figure.value << ", goal "
                                 << figure.goal_text();
  });
}

}  // namespace
}  // namespace touchtrace
