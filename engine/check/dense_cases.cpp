// Operation `dense`: a layer with bias, and the GEMMs and column sums of its gradients, as the
// model calls them.
#include <fmt/core.h>

#include "engine/base/integer_math.h"
#include "engine/check/dense_reference.h"
#include "engine/check/host_arrays.h"
#include "engine/check/rows.h"
#include "engine/ops/dense.h"

namespace touchtrace {
namespace {

constexpr int vector_lanes = 16;

int padded(int columns) { return round_up(columns, vector_lanes); }

/// Matrix on the device with rows padded to whole vectors.
MatrixView upload_padded(Runtime& runtime, const std::vector<double>& values, int columns) {
  return {upload(runtime, padded_rows(values, columns, padded(columns))), 0, padded(columns)};
}

MatrixView allocate(Runtime& runtime, int rows, int columns) {
  return {runtime.allocate<float>(std::size_t(rows) * columns), 0, columns};
}

Arrays forward(Runtime& runtime, const DenseShape& s, const Arrays& in) {
  const auto x = upload_padded(runtime, in[0], s.inputs);
  const auto weight = upload_padded(runtime, in[1], s.inputs);
  const auto bias = upload_padded(runtime, in[2], s.outputs);
  const auto by_input = allocate(runtime, s.inputs, padded(s.outputs));
  const auto out = allocate(runtime, s.rows, s.outputs);
  pack(runtime, weight.transposed(), by_input, s.inputs, s.outputs, padded(s.outputs))
      .enqueue(runtime);
  enqueue(runtime, gemm(runtime, x, by_input, bias, out, s.rows, s.outputs, s.inputs));
  return {download(runtime, out.buffer)};
}

Arrays backward(Runtime& runtime, const DenseShape& s, const Arrays& in, const Arrays& grads) {
  const auto x = upload_padded(runtime, in[0], s.inputs);
  const auto weight = upload_padded(runtime, in[1], s.inputs);
  const auto grad = upload_padded(runtime, grads[0], s.outputs);
  const auto grad_x = allocate(runtime, s.rows, s.inputs);
  const auto grad_weight = allocate(runtime, s.outputs, s.inputs);
  const auto grad_bias = allocate(runtime, 1, s.outputs);
  enqueue(runtime, gemm(runtime, grad, weight, {}, grad_x, s.rows, s.inputs, s.outputs));
  enqueue(runtime,
          gemm(runtime, grad.transposed(), x, {}, grad_weight, s.outputs, s.inputs, s.rows));
  column_sums(runtime, grad, grad_bias, s.rows, s.outputs).enqueue(runtime);
  return {download(runtime, grad_x.buffer), download(runtime, grad_weight.buffer),
          download(runtime, grad_bias.buffer)};
}

OperationCase dense_case(const DenseShape& s) {
  OperationCase c;
  c.shape = fmt::format("{} rows of {} to {}", s.rows, s.inputs, s.outputs);
  c.input_sizes = {std::size_t(s.rows) * s.inputs, std::size_t(s.outputs) * s.inputs,
                   std::size_t(s.outputs)};
  c.terms = s.inputs + 1;
  c.reference = [s](const Arrays& in) { return Arrays{dense_reference(s, in[0], in[1], in[2])}; };
  c.forward = [s](Runtime& runtime, const Arrays& in) { return forward(runtime, s, in); };
  c.reference_backward = [s](const Arrays& in, const Arrays& grads) {
    auto grad = dense_backward_reference(s, in[0], in[1], grads[0]);
    return Arrays{grad.in, grad.weight, grad.bias};
  };
  c.backward = [s](Runtime& runtime, const Arrays& in, const Arrays& grads) {
    return backward(runtime, s, in, grads);
  };
  return c;
}

}  // namespace

Operation dense_operation() {
  Operation operation{"dense", {}, 1, true};
  for (const DenseShape& shape : {DenseShape{3, 5, 7},
                                  {1, 1, 1},
                                  {13, 100, 130},
                                  {4, 12, 256},
                                  {33, 64, 256},
                                  {20, 2048, 64},
                                  {9, 256, 24}})
    operation.cases.push_back(dense_case(shape));
  return operation;
}

}  // namespace touchtrace
