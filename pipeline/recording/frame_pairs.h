#pragma once

#include <cstdint>
#include <vector>

namespace touchtrace {

/// Indices of a depth image and of the colour image nearest in time.
struct FramePair {
  std::size_t color, depth;
};

/// Pairs each depth image with the colour image nearest in time, if their stamps differ by at most
/// half of the slower stream's median interval. Without colour images or without depth images there
/// are no pairs. Both vectors increase.
std::vector<FramePair> pair_frames(const std::vector<double>& color_s,
                                   const std::vector<double>& depth_s);

/// Inverse of the median interval, of the mean interval if the median is 0; `fallback` for fewer
/// than 2 different stamps.
double rate_of(const std::vector<double>& time_s, double fallback);

/// Whether frames that are this far apart have a pause between them: 0.5 s and 5 frames at least.
bool is_pause(double gap_s, double rate_hz);

/// Fills an empty counter of frames with these times: 0, 1, ..., and over a pause as many numbers
/// as frames at `rate_hz` would have. At a rate of 0 there are no pauses.
void fill_sequence(std::vector<std::uint64_t>& sequence, const std::vector<double>& time_s,
                   double rate_hz);

}  // namespace touchtrace
