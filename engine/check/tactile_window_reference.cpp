#include "engine/check/tactile_window_reference.h"

namespace touchtrace {
namespace {

std::uint32_t mix(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

}  // namespace

double kept(const TaxelDropout& dropout, std::uint32_t taxels, std::uint32_t window,
            std::uint32_t taxel) {
  const bool blanked = mix(mix(window * taxels + taxel) ^ dropout.key) < dropout.threshold();
  return blanked ? 0.0 : 1.0 / (1.0 - dropout.share);
}

std::vector<double> tactile_window_reference(const TactileWindowShape& s,
                                             const std::vector<double>& stream,
                                             const std::vector<int>& last_frame,
                                             const TaxelDropout& dropout) {
  const int taxels = s.rows * s.cols;
  std::vector<double> out;
  for (int window = 0; window < s.windows; ++window)
    for (int c = 0; c < s.frames; ++c)
      for (int taxel = 0; taxel < taxels; ++taxel) {
        const auto frame = static_cast<std::size_t>(last_frame[window] - s.frames + 1 + c);
        const double value = stream[frame * taxels + taxel];
        const double change = c + 1 < s.frames ? stream[(frame + 1) * taxels + taxel] - value : 0.0;
        out.push_back(kept(dropout, taxels, window, taxel) *
                      (c + 1 < s.frames ? 5.0 * change : value));
      }
  return out;
}

}  // namespace touchtrace
