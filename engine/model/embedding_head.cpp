#include "engine/model/embedding_head.h"

#include <cmath>

namespace touchtrace {

void EmbeddingHead::declare(const std::string& name, int size, const ChannelBlocksShape& features,
                            ParameterTable& table) {
  const int feature_size = features.channels * features.rows * features.cols;
  const Initial dense{0.0, 1.0 / std::sqrt(feature_size)};
  table.add(name + ".dense.weight", {size, feature_size}, dense);
  table.add(name + ".dense.bias", {size}, dense);
  table.add(name + ".norm.weight", {size}, {1.0, 0.0});
  table.add(name + ".norm.bias", {size}, {0.0, 0.0});
}

EmbeddingHead::EmbeddingHead(Runtime& runtime, const std::string& name, const Weights& weights,
                             const ChannelBlocksShape& shape, const Buffer<float>& features,
                             const Buffer<float>& grad_features) {
  const int rows = shape.images, size = weights.table.at(name + ".dense.bias").shape.front();
  const auto weight = weights.value(name + ".dense.weight");
  const int feature_size = weight.row;
  weight_shape_ = shape;
  weight_shape_.images = size;
  weight_ = {runtime.allocate<float>(weight_shape_.row_size()), 0, feature_size};
  const MatrixView by_input{runtime.allocate<float>(weight_shape_.row_size()), 0, size};
  const MatrixView input{features, 0, feature_size};
  const auto values = std::size_t(rows) * size;
  norm_ = {.rows = rows,
           .columns = size,
           .parameters = weights.values,
           .gain_at = weights.value(name + ".norm.weight").at,
           .bias_at = weights.value(name + ".norm.bias").at,
           .x = runtime.allocate<float>(values),
           .y = runtime.allocate<float>(values),
           .statistics = runtime.allocate<float>(2 * std::size_t(rows))};
  prepare_ = {to_blocks(runtime, weight_shape_, weight, weight_.buffer),
              pack(runtime, weight_.transposed(), by_input, feature_size, size, size)};
  forward_ = gemm(runtime, input, by_input, weights.value(name + ".dense.bias"), {norm_.x, 0, size},
                  rows, size, feature_size);
  forward_.push_back(layer_norm(runtime, norm_));
  if (weights.gradient.size() > 0)
    plan_backward(runtime, name, weights, input, {grad_features, 0, feature_size});
}

void EmbeddingHead::plan_backward(Runtime& runtime, const std::string& name, const Weights& weights,
                                  const MatrixView& features, const MatrixView& grad_features) {
  const int rows = norm_.rows, size = norm_.columns, feature_size = features.row;
  grad_embedding_ = runtime.allocate<float>(norm_.y.size());
  const MatrixView grad{runtime.allocate<float>(norm_.x.size()), 0, size};
  const MatrixView grad_weight{runtime.allocate<float>(weight_shape_.row_size()), 0, feature_size};
  backward_ = {layer_norm_backward(runtime, norm_, grad_embedding_, grad.buffer),
               layer_norm_weights(runtime, norm_, grad_embedding_, weights.gradient)};
  append(backward_,
         gemm(runtime, grad.transposed(), features, {}, grad_weight, size, feature_size, rows));
  backward_.push_back(from_blocks(runtime, weight_shape_, grad_weight.buffer,
                                  weights.grad(name + ".dense.weight")));
  backward_.push_back(column_sums(runtime, grad, weights.grad(name + ".dense.bias"), rows, size));
  append(backward_,
         with_purpose(gemm(runtime, grad, weight_, {}, grad_features, rows, feature_size, size),
                      Purpose::data_gradient));
}

}  // namespace touchtrace
