#include <algorithm>

#include "pipeline/acquire/import/source/source.h"

namespace touchtrace {

std::vector<double> host_times_s(const SourceStream& stream) {
  std::vector<double> times_s;
  for (const auto& image : stream.images) times_s.push_back(image.host_time_s);
  return times_s;
}

std::size_t nearest_image(const SourceStream& stream, double time_s) {
  const auto after = std::ranges::lower_bound(stream.images, time_s, {}, &SourceImage::host_time_s);
  if (after == stream.images.begin()) return 0;
  const auto index = static_cast<std::size_t>(after - stream.images.begin());
  if (after == stream.images.end()) return index - 1;
  return after->host_time_s - time_s < time_s - std::prev(after)->host_time_s ? index : index - 1;
}

}  // namespace touchtrace
