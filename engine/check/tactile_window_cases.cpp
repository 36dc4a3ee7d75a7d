// Operation `tactile_window`. Inputs: the stream, and the last frame of each window. No gradient.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/check/host_arrays.h"
#include "engine/check/rows.h"
#include "engine/check/tactile_window_reference.h"
#include "engine/ops/tactile_window.h"

namespace touchtrace {
namespace {

constexpr int stream_frames = 40;

std::vector<int> last_frames(const Arrays& inputs) { return {inputs[1].begin(), inputs[1].end()}; }

Arrays forward(Runtime& runtime, const TactileWindowShape& s, const TaxelDropout& dropout,
               const Arrays& inputs) {
  const auto out = runtime.allocate_zeros<float>(s.out_size());
  const auto last = last_frames(inputs);
  TactileWindow(runtime, s, out)
      .enqueue(runtime, upload(runtime, inputs[0]), runtime.upload<int>(last), dropout);
  return {without_halo(download(runtime, out), {s.rows, s.cols, 1, s.halo})};
}

/// Turns the second input into frame numbers.
void prepare(const TactileWindowShape& s, Arrays& inputs) {
  for (auto& value : inputs[1])
    value =
        s.frames - 1 + std::fmod(std::abs(std::round(value * 100)), stream_frames - s.frames + 1);
}

OperationCase tactile_window_case(const TactileWindowShape& s, const TaxelDropout& dropout) {
  OperationCase c;
  c.shape = fmt::format("{} windows {}x{}x{} with {} blanked", s.windows, s.frames, s.rows, s.cols,
                        dropout.share);
  c.input_sizes = {std::size_t(stream_frames) * s.rows * s.cols, std::size_t(s.windows)};
  c.terms = 2;
  c.reference = [=](const Arrays& in) {
    return Arrays{tactile_window_reference(s, in[0], last_frames(in), dropout)};
  };
  c.forward = [=](Runtime& runtime, const Arrays& in) { return forward(runtime, s, dropout, in); };
  c.prepare = [s](Arrays& in) { prepare(s, in); };
  return c;
}

}  // namespace

Operation tactile_window_operation() {
  return {
      "tactile_window",
      {tactile_window_case({3, 2, 3, 5}, {0.5, 7}), tactile_window_case({4, 10, 32, 32}, {0.2, 1}),
       tactile_window_case({1, 1, 6, 6}, {0.0, 0}), tactile_window_case({2, 32, 9, 24}, {0.0, 5}),
       tactile_window_case({7, 4, 8, 17, 2}, {0.9, 0xFFFFFFFFu})},
      1,
      true};
}

}  // namespace touchtrace
