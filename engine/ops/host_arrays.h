#pragma once

#include <utility>
#include <vector>

#include "engine/cl/runtime.h"

namespace touchtrace {

// Moving the double arrays of the table of operations to a device and back.

Buffer<float> upload(Runtime& runtime, const std::vector<double>& values);
std::vector<double> download(Runtime& runtime, const Buffer<float>& buffer);

std::vector<double> joined(std::vector<double> first, const std::vector<double>& second);
/// The first `size` values, and the rest.
std::pair<std::vector<double>, std::vector<double>> split(const std::vector<double>& values,
                                                          std::size_t size);

/// From plain [.., channel, row, column] to groups of `lanes` channels with a halo of one zero
/// pixel,
/// [.., channel / lanes, row + 1, column + 1, channel % lanes], and back.
std::vector<double> with_halo(const std::vector<double>& plain, int rows, int cols, int lanes);
std::vector<double> without_halo(const std::vector<double>& haloed, int rows, int cols, int lanes);

/// Rows [channel][pixel] as [channel / 16][pixel][channel % 16] (channel_blocks.h), and back.
std::vector<double> in_block_order(const std::vector<double>& values, int channels, int pixels);
std::vector<double> in_plain_order(const std::vector<double>& values, int channels, int pixels);

}  // namespace touchtrace
