// Operation `state_loss`. Inputs: predicted states, spread and target, each [T, S, state], and the
// weight of each row. Output: loss of each row.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/check/host_arrays.h"
#include "engine/check/rows.h"
#include "engine/check/state_loss_reference.h"
#include "engine/ops/rollout.h"
#include "engine/ops/state_loss.h"

namespace touchtrace {
namespace {

struct Shape {
  int sequences, steps, state;
  float band_quantile;

  std::size_t rows() const { return std::size_t(sequences) * steps; }
};

/// Rows of 16 after `lead` rows of NaN. Neither these nor the padding may affect the result.
Buffer<float> upload_rows(Runtime& runtime, const std::vector<double>& values, int state,
                          int lead) {
  std::vector<double> rows((values.size() / state + lead) * state_lanes, std::nan(""));
  for (std::size_t i = 0; i < values.size(); ++i)
    rows[(i / state + lead) * state_lanes + i % state] = values[i];
  return upload(runtime, rows);
}

StateLossArrays computed(Runtime& runtime, const Shape& s, const Arrays& in) {
  StateLossArrays a{.sequences = s.sequences,
                    .steps = s.steps,
                    .state = s.state,
                    .band_quantile = s.band_quantile,
                    .states = upload_rows(runtime, in[0], s.state, s.sequences),
                    .spread = upload_rows(runtime, in[1], s.state, 0),
                    .target = upload_rows(runtime, in[2], s.state, 0),
                    .weight = upload(runtime, in[3]),
                    .row_loss = runtime.allocate<float>(s.rows()),
                    .grad_state = runtime.allocate<float>(s.rows() * state_lanes),
                    .grad_spread = runtime.allocate<float>(s.rows() * state_lanes)};
  state_loss(runtime, a).enqueue(runtime);
  return a;
}

Arrays backward(Runtime& runtime, const Shape& s, const Arrays& in, const Arrays& grads) {
  const auto arrays = computed(runtime, s, in);
  auto state = unpadded_rows(download(runtime, arrays.grad_state), s.state, state_lanes);
  auto spread = unpadded_rows(download(runtime, arrays.grad_spread), s.state, state_lanes);
  for (std::size_t i = 0; i < state.size(); ++i) {
    state[i] *= grads[0][i / s.state];
    spread[i] *= grads[0][i / s.state];
  }
  return {state, spread, {}, {}};
}

/// Unweighted loss of value i.
StateLoss loss_of_value(const Shape& s, const Arrays& in, std::size_t i) {
  return state_loss_reference(in[0][i], in[1][i], in[2][i], s.band_quantile);
}

Arrays loss_of(const Shape& s, const Arrays& in) {
  std::vector<double> rows(s.rows(), 0.0);
  for (std::size_t i = 0; i < in[0].size(); ++i)
    rows[i / s.state] += in[3][i / s.state] * loss_of_value(s, in, i).value;
  return {rows};
}

Arrays reference_backward(const Shape& s, const Arrays& in, const Arrays& grads) {
  Arrays result(4);
  for (std::size_t i = 0; i < in[0].size(); ++i) {
    const auto loss = loss_of_value(s, in, i);
    const double scale = grads[0][i / s.state] * in[3][i / s.state];
    result[0].push_back(scale * loss.grad_state);
    result[1].push_back(scale * loss.grad_spread);
  }
  return result;
}

double loss_kink_distance(const Arrays& in) {
  double distance = 1.0;
  for (std::size_t i = 0; i < in[0].size(); ++i) {
    const double d = in[2][i] - in[0][i];
    distance = std::min({distance, std::abs(d), std::abs(d + in[1][i]), std::abs(d - in[1][i])});
  }
  return distance;
}

OperationCase state_loss_case(const Shape& s) {
  OperationCase c;
  c.shape = fmt::format("{} sequences x {} steps, state {}, quantile {}", s.sequences, s.steps,
                        s.state, s.band_quantile);
  const auto values = s.rows() * s.state;
  c.input_sizes = {values, values, values, s.rows()};
  c.terms = s.state;
  c.reference = [s](const Arrays& in) { return loss_of(s, in); };
  c.forward = [s](Runtime& runtime, const Arrays& in) {
    return Arrays{download(runtime, computed(runtime, s, in).row_loss)};
  };
  c.reference_backward = [s](const Arrays& in, const Arrays& g) {
    return reference_backward(s, in, g);
  };
  c.backward = [s](Runtime& runtime, const Arrays& in, const Arrays& g) {
    return backward(runtime, s, in, g);
  };
  c.kink_distance = loss_kink_distance;
  c.prepare = [](Arrays& in) {
    for (std::size_t input : {1, 3})
      for (double& value : in[input]) value = std::abs(value);
  };
  return c;
}

}  // namespace

Operation state_loss_operation() {
  return {"state_loss",
          {state_loss_case({2, 2, 3, 0.1f}), state_loss_case({8, 20, 12, 0.25f}),
           state_loss_case({1, 1, 16, 0.01f}), state_loss_case({32, 20, 12, 0.1f}),
           state_loss_case({3, 5, 7, 0.49f})}};
}

}  // namespace touchtrace
