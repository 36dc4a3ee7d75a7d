#include "pipeline/label/foreground.h"

namespace touchtrace::label {
namespace {

constexpr int fewest = 5;  // of a pixel and its neighbours

/// Less one, so that 0 (no measurement, no limit) is farthest.
std::uint16_t order(std::uint16_t count) { return static_cast<std::uint16_t>(count - 1); }

}  // namespace

Foreground::Foreground(const std::vector<std::uint16_t>& depth,
                       const std::vector<std::uint16_t>& limit, int width)
    : depth_(depth), limit_(limit), width_(static_cast<std::size_t>(width)), columns_(width_) {
  for (auto& row : before_) row.resize(width_);
}

void Foreground::mark(std::size_t v) {
  auto& row = before_[v % 3];
  const std::uint16_t *depth = &depth_[v * width_], *limit = &limit_[v * width_];
  for (std::size_t u = 0; u < width_; ++u) row[u] = order(depth[u]) < order(limit[u]);
}

const std::vector<std::size_t>& Foreground::row(std::size_t v) {
  if (v == 1) mark(0), mark(1);
  mark(v + 1);
  const auto &above = before_[(v - 1) % 3], &here = before_[v % 3], &below = before_[(v + 1) % 3];
  for (std::size_t u = 0; u < width_; ++u)
    columns_[u] = static_cast<std::uint8_t>(above[u] + here[u] + below[u]);
  pixels_.clear();
  for (std::size_t u = 1; u + 1 < width_; ++u)
    if (here[u] != 0 && columns_[u - 1] + columns_[u] + columns_[u + 1] >= fewest)
      pixels_.push_back(v * width_ + u);
  return pixels_;
}

}  // namespace touchtrace::label
