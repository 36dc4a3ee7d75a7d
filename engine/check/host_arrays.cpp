#include "engine/check/host_arrays.h"

namespace touchtrace {
namespace {

/// Calls `visit(plain, haloed)` with the flat indices of each value in both layouts.
template <class Visit>
void visit_values(std::size_t planes, const HaloLayout& layout, Visit visit) {
  const auto [rows, cols, lanes, halo] = layout;
  for (std::size_t plane = 0; plane < planes; ++plane)
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < cols; ++column) {
        const auto group = plane / lanes * (rows + 2 * halo) + row + halo;
        visit((plane * rows + row) * cols + column,
              (group * (cols + 2 * halo) + column + halo) * lanes + plane % lanes);
      }
}

/// Number of pixels of a plane, halo included.
std::size_t haloed_area(const HaloLayout& layout) {
  return std::size_t(layout.rows + 2 * layout.halo) * (layout.cols + 2 * layout.halo);
}

}  // namespace

Buffer<float> upload(Runtime& runtime, const std::vector<double>& values) {
  const std::vector<float> floats(values.begin(), values.end());
  return runtime.upload<float>(floats);
}

std::vector<double> download(Runtime& runtime, const Buffer<float>& buffer) {
  const auto floats = runtime.download(buffer);
  return {floats.begin(), floats.end()};
}

std::vector<double> joined(std::vector<double> first, const std::vector<double>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

std::pair<std::vector<double>, std::vector<double>> split(const std::vector<double>& values,
                                                          std::size_t size) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(size);
  return {{values.begin(), middle}, {middle, values.end()}};
}

std::vector<double> with_halo(const std::vector<double>& plain, const HaloLayout& layout) {
  const auto planes = plain.size() / (std::size_t(layout.rows) * layout.cols);
  std::vector<double> haloed(planes * haloed_area(layout), 0.0);
  visit_values(planes, layout, [&](auto from, auto to) { haloed[to] = plain[from]; });
  return haloed;
}

std::vector<double> without_halo(const std::vector<double>& haloed, const HaloLayout& layout) {
  const auto planes = haloed.size() / haloed_area(layout);
  std::vector<double> plain(planes * layout.rows * layout.cols);
  visit_values(planes, layout, [&](auto to, auto from) { plain[to] = haloed[from]; });
  return plain;
}

namespace {

/// Index in block order of value i of rows [channel][pixel].
std::size_t block_place(std::size_t i, int channels, int pixels) {
  const std::size_t channel = i / pixels % channels, row = i / pixels / channels;
  return ((row * channels / 16 + channel / 16) * pixels + i % pixels) * 16 + channel % 16;
}

}  // namespace

std::vector<double> in_block_order(const std::vector<double>& values, int channels, int pixels) {
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    result[block_place(i, channels, pixels)] = values[i];
  return result;
}

std::vector<double> in_plain_order(const std::vector<double>& values, int channels, int pixels) {
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    result[i] = values[block_place(i, channels, pixels)];
  return result;
}

std::vector<double> transposed(const std::vector<double>& values, std::size_t rows,
                               std::size_t columns) {
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; ++j) result[j * rows + i] = values[i * columns + j];
  return result;
}

std::vector<double> padded_rows(const std::vector<double>& values, std::size_t columns,
                                std::size_t padded_columns) {
  std::vector<double> result(values.size() / columns * padded_columns, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i)
    result[i / columns * padded_columns + i % columns] = values[i];
  return result;
}

std::vector<double> unpadded_rows(const std::vector<double>& values, std::size_t columns,
                                  std::size_t padded_columns) {
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (i % padded_columns < columns) result.push_back(values[i]);
  return result;
}

}  // namespace touchtrace
