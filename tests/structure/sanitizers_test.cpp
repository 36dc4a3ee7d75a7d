// Builds with sanitizers end at the first fault, so that a test fails.
#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace {

TEST(SanitizersDeathTest, UndefinedBehaviorEndsTheProcess) {
  if (std::string(SANITIZERS).find("undefined") == std::string::npos)
    GTEST_SKIP() << "not built with the UndefinedBehaviorSanitizer";
  EXPECT_DEATH(
      {
        volatile int value = std::numeric_limits<int>::max();
        value = value + 1;
      },
      "signed integer overflow");
}

}  // namespace
