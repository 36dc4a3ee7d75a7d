#include "calib/board/opencv_threads.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace touchtrace {
namespace {

TEST(OpenCvThreads, RestoresThePreviousNumber) {
  const OpenCvThreads outer(3);
  ASSERT_EQ(cv::getNumThreads(), 3);
  {
    const OpenCvThreads inner(1);
    EXPECT_EQ(cv::getNumThreads(), 1);
  }
  EXPECT_EQ(cv::getNumThreads(), 3);
}

TEST(OpenCvThreads, RestoresThePreviousNumberAfterAnException) {
  const OpenCvThreads outer(3);
  try {
    const OpenCvThreads inner(1);
    throw std::runtime_error("tracker failed");
  } catch (const std::runtime_error&) {
  }
  EXPECT_EQ(cv::getNumThreads(), 3);
}

}  // namespace
}  // namespace touchtrace
