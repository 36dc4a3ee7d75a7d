#include "pipeline/label/observe/foreground.h"

#include <algorithm>

#include "engine/base/integer_math.h"

namespace touchtrace::label {
namespace {

constexpr std::uint8_t min_before = 3;  // of the nine pixels around and including one
constexpr std::uint8_t measured = 16;   // more than nine
constexpr std::size_t block = 8;

// The loops run over plain pointers so that the compiler vectorises them.

/// Subtracts one with wrap-around, so that 0 (no measurement, no limit) compares as farthest.
std::uint16_t order(std::uint16_t count) { return static_cast<std::uint16_t>(count - 1); }

void mark_row(const std::uint16_t* depth, const std::uint16_t* limit, std::size_t width,
              std::uint8_t* marks) {
  for (std::size_t u = 0; u < width; ++u)
    marks[u] =
        static_cast<std::uint8_t>((order(depth[u]) < order(limit[u])) + measured * (depth[u] != 0));
}

void add_rows(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
              std::size_t width, std::uint8_t* sum) {
  for (std::size_t u = 0; u < width; ++u) sum[u] = static_cast<std::uint8_t>(a[u] + b[u] + c[u]);
}

void remove_speckles(const std::uint8_t* marks, const std::uint8_t* columns, std::size_t width,
                     std::uint8_t* clean) {
  for (std::size_t u = 1; u + 1 < width; ++u) {
    const auto sum = static_cast<std::uint8_t>(columns[u - 1] + columns[u] + columns[u + 1]);
    const auto before = static_cast<std::uint8_t>(sum % measured);
    clean[u] = static_cast<std::uint8_t>(marks[u] & (before >= min_before) &
                                         (2 * before > sum / measured));
  }
}

}  // namespace

Foreground::Foreground(const std::vector<std::uint16_t>& depth,
                       const std::vector<std::uint16_t>& limit, int width)
    : depth_(depth),
      limit_(limit),
      width_(static_cast<std::size_t>(width)),
      columns_(width_),
      clean_(round_up(width_, block)) {
  for (auto& row : marks_) row.resize(width_);
}

void Foreground::mark(std::size_t v) {
  mark_row(&depth_[v * width_], &limit_[v * width_], width_, marks_[v % 3].data());
}

const std::vector<std::size_t>& Foreground::row(std::size_t v) {
  if (v == 1) mark(0), mark(1);
  mark(v + 1);
  add_rows(marks_[(v - 1) % 3].data(), marks_[v % 3].data(), marks_[(v + 1) % 3].data(), width_,
           columns_.data());
  remove_speckles(marks_[v % 3].data(), columns_.data(), width_, clean_.data());
  gather(v * width_);
  return pixels_;
}

/// Skips eight background pixels at a time; most pixels are background.
void Foreground::gather(std::size_t first) {
  pixels_.clear();
  for (std::size_t u = 0; u < width_; u += block) {
    const auto *begin = &clean_[u], *end = begin + block;
    if (std::all_of(begin, end, [](std::uint8_t is_clean) { return is_clean == 0; })) continue;
    for (auto at = begin; at != end; ++at)
      if (*at != 0) pixels_.push_back(first + static_cast<std::size_t>(at - clean_.data()));
  }
}

}  // namespace touchtrace::label
