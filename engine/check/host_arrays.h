#pragma once

#include <utility>
#include <vector>

#include "engine/cl/runtime.h"

namespace touchtrace {

// Transfers and layout changes of the double arrays of OperationCase.

/// Rounds to float.
Buffer<float> upload(Runtime& runtime, const std::vector<double>& values);
std::vector<double> download(Runtime& runtime, const Buffer<float>& buffer);

/// Concatenates two arrays.
std::vector<double> joined(std::vector<double> first, const std::vector<double>& second);
/// Returns the first `size` values and the remaining ones.
std::pair<std::vector<double>, std::vector<double>> split(const std::vector<double>& values,
                                                          std::size_t size);

/// Layout of images in blocks of `lanes` channels with a halo of zero pixels:
/// [..., channel / lanes, row + halo, column + halo, channel % lanes].
struct HaloLayout {
  int rows, cols, lanes, halo;
};

/// Transposes [rows, columns] to [columns, rows].
std::vector<double> transposed(const std::vector<double>& values, std::size_t rows,
                               std::size_t columns);
/// Pads rows of `columns` values with zeros to `padded_columns`, and removes the padding.
std::vector<double> padded_rows(const std::vector<double>& values, std::size_t columns,
                                std::size_t padded_columns);
std::vector<double> unpadded_rows(const std::vector<double>& values, std::size_t columns,
                                  std::size_t padded_columns);

/// Converts [..., channel, row, column] to HaloLayout, and back.
std::vector<double> with_halo(const std::vector<double>& plain, const HaloLayout& layout);
std::vector<double> without_halo(const std::vector<double>& haloed, const HaloLayout& layout);

/// Converts rows [channel][pixel] to [channel / 16][pixel][channel % 16] (channel_blocks.h), and
/// back.
std::vector<double> in_block_order(const std::vector<double>& values, int channels, int pixels);
std::vector<double> in_plain_order(const std::vector<double>& values, int channels, int pixels);

}  // namespace touchtrace
