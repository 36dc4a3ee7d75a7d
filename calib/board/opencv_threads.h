#pragma once

#include <opencv2/core/utility.hpp>

namespace touchtrace {

/// Sets the number of threads that OpenCV functions use, in the whole process, for its lifetime.
/// Restores the previous number. Not for concurrent use.
class OpenCvThreads {
 public:
  explicit OpenCvThreads(int count) : previous_(cv::getNumThreads()) { cv::setNumThreads(count); }
  ~OpenCvThreads() { cv::setNumThreads(previous_); }
  OpenCvThreads(const OpenCvThreads&) = delete;
  OpenCvThreads& operator=(const OpenCvThreads&) = delete;

 private:
  int previous_;
};

}  // namespace touchtrace
