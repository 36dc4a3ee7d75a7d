#include "engine/ops/tuning.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace touchtrace {
namespace {

const Conv2dShape& shape_of(const Tuning::Layer& row) { return row.shape; }
const Conv2dShape& shape_of(const Tuning::MicroBatch& row) { return row.first_layer; }

/// Ignores the number of images and dead pixels, which depend on the data.
bool same_layer(const Conv2dShape& a, const Conv2dShape& b) {
  const auto key = [](const Conv2dShape& s) {
    return std::tuple(s.in_channels, s.rows, s.cols, s.out_channels, s.in_planes, s.kernel,
                      s.stride);
  };
  return key(a) == key(b);
}

/// Ratio of the numbers of images, >= 1.
double ratio_of_images(const Conv2dShape& a, const Conv2dShape& b) {
  const auto [few, many] = std::minmax(a.images, b.images);
  return static_cast<double>(many) / few;
}

/// Prefers fewer images among equally near ones.
template <class Row>
const Row* nearest(const std::vector<Row>& rows, const Conv2dShape& shape, double max_ratio) {
  const Row* best = nullptr;
  const auto key = [&](const Row& row) {
    return std::pair(ratio_of_images(shape_of(row), shape), shape_of(row).images);
  };
  for (const auto& row : rows)
    if (same_layer(shape_of(row), shape) && key(row).first <= max_ratio &&
        (!best || key(row) < key(*best)))
      best = &row;
  return best;
}

template <class Row>
void replace(std::vector<Row>& rows, const Row& row) {
  std::erase_if(rows, [&](const Row& other) {
    return same_layer(shape_of(other), shape_of(row)) &&
           shape_of(other).images == shape_of(row).images;
  });
  rows.push_back(row);
}

}  // namespace

const Tuning::Layer* Tuning::layer(const Conv2dShape& shape) const {
  return nearest(layers, shape, 2.0);
}

const Tuning::MicroBatch* Tuning::micro_batch(const Conv2dShape& first_layer) const {
  return nearest(micro_batches, first_layer, std::numeric_limits<double>::infinity());
}

void Tuning::set(const Layer& layer) { replace(layers, layer); }

void Tuning::set(const MicroBatch& batch) { replace(micro_batches, batch); }

}  // namespace touchtrace
