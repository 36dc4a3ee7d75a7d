#include "engine/model/conv_stack_shape.h"

#include <fmt/core.h>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

constexpr std::array conv_channels{32, 64, 128};

void check_window(const TactileWindowShape& window) {
  const auto fits = [](int size) { return size >= 1 && size <= 64; };
  if (!fits(window.rows) || !fits(window.cols) || window.frames < 1 || window.frames > 32)
    throw usage_error(
        fmt::format("tactile window of {} frames of {} x {}; expected 1..32 frames of 1..64 x "
                    "1..64",
                    window.frames, window.rows, window.cols),
        "change --window or --resolution");
}

/// Dead pixels, if skipping them saves more than processing pixels out of memory order costs.
std::vector<int> worthwhile_dead_pixels(const Conv2dShape& layer, const LiveTaxels& live) {
  constexpr int min_pixels_per_dead = 8;
  if (live.empty()) return {};
  auto dead = dead_pixels(layer, live);
  if (min_pixels_per_dead * static_cast<int>(dead.size()) < layer.out_rows() * layer.out_cols())
    dead.clear();
  return dead;
}

}  // namespace

LiveTaxels live_taxels(std::span<const float> stream, std::size_t taxels) {
  LiveTaxels live(taxels, 0);
  for (std::size_t i = 0; i < stream.size(); ++i)
    if (stream[i] != 0.0f) live[i % taxels] = 1;
  return live;
}

ConvStackShape ConvStackShape::of_windows(int count) const {
  auto shape = *this;
  shape.windows.windows = count;
  shape.windows.halo = kernel / 2;
  return shape;
}

std::array<Conv2dShape, 3> ConvStackShape::layers() const {
  check_window(windows);
  std::array<Conv2dShape, 3> layers{};
  Conv2dShape layer{
      windows.windows, windows.frames, windows.rows, windows.cols, 0, true, kernel, 0};
  for (int i = 0; i < 3; ++i) {
    layer.out_channels = conv_channels[i], layer.stride = strides[i];
    layers[i] = layer;
    layer.in_channels = conv_channels[i], layer.in_planes = false;
    layer.rows = layers[i].out_rows(), layer.cols = layers[i].out_cols();
  }
  layers[2].compact_output = true;
  layers[0].dead = worthwhile_dead_pixels(layers[0], live);
  return layers;
}

ChannelBlocksShape ConvStackShape::features() const {
  const auto last = layers()[2];
  return {last.images, last.out_channels, last.out_rows(), last.out_cols(), last.halo()};
}

}  // namespace touchtrace
