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

/// Images in groups of `lanes` channels with a halo of zero pixels,
/// [.., channel / lanes, row + halo, column + halo, channel % lanes].
struct HaloLayout {
  int rows, cols, lanes, halo;
};

/// [rows, columns] as [columns, rows].
std::vector<double> transposed(const std::vector<double>& values, std::size_t rows,
                               std::size_t columns);
/// Rows of `columns` values, each followed by zeros up to `padded_columns`; and back.
std::vector<double> padded_rows(const std::vector<double>& values, std::size_t columns,
                                std::size_t padded_columns);
std::vector<double> unpadded_rows(const std::vector<double>& values, std::size_t columns,
                                  std::size_t padded_columns);

/// From plain [.., channel, row, column] to such images, and back.
std::vector<double> with_halo(const std::vector<double>& plain, const HaloLayout& layout);
std::vector<double> without_halo(const std::vector<double>& haloed, const HaloLayout& layout);

/// Rows [channel][pixel] as [channel / 16][pixel][channel % 16] (channel_blocks.h), and back.
std::vector<double> in_block_order(const std::vector<double>& values, int channels, int pixels);
std::vector<double> in_plain_order(const std::vector<double>& values, int channels, int pixels);

}  // namespace touchtrace
