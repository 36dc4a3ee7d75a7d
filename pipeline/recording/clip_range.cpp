#include "pipeline/recording/clip_range.h"

#include <algorithm>

namespace touchtrace {

IndexRange arrived_in(const Clip& clip, const std::vector<double>& host_time_s) {
  const auto index = [&](auto at) { return static_cast<std::size_t>(at - host_time_s.begin()); };
  const std::size_t first = index(std::ranges::lower_bound(host_time_s, clip.start_s));
  return {first, std::max(first, index(std::ranges::upper_bound(host_time_s, clip.end_s)))};
}

}  // namespace touchtrace
