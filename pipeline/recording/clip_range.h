#pragma once

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Indices [first, last).
struct IndexRange {
  std::size_t first = 0, last = 0;

  std::size_t size() const { return last - first; }
  bool contains(std::size_t index) const { return index >= first && index < last; }
};

/// Elements of a stream that arrived in a clip. `host_time_s` must not decrease.
IndexRange arrived_in(const Clip& clip, const std::vector<double>& host_time_s);

}  // namespace touchtrace
