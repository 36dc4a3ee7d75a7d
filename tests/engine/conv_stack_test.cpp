#include "engine/model/conv_stack.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/check/host_arrays.h"
#include "engine/check/operation_check.h"
#include "engine/check/tactile_window_reference.h"
#include "tests/verify/engine/encoder_reference.h"

namespace touchtrace {
namespace {

constexpr int stream_frames = 40;

std::vector<double> normal_floats(std::size_t size, const char* name) {
  RandomStream random(20, name);
  return touchtrace::normal_floats<double>(size, random);
}

class ConvStackOfShape : public ::testing::TestWithParam<ConvStackShape> {};

TEST_P(ConvStackOfShape, MatchesReference) {
  const auto shape = GetParam();
  const auto& [windows, frames, rows, cols, halo] = shape.windows;
  Runtime runtime(choose_device(""));
  ParameterTable table;
  table.add("something before", {7}, {});
  ConvStack::declare("object", shape, table);
  const auto initial = table.initial_values(3);
  const std::vector<double> parameters(initial.begin(), initial.end());
  const auto stream = normal_floats(std::size_t(stream_frames) * rows * cols, "stream");
  std::vector<int> window_end;
  for (int w = 0; w < windows; ++w)
    window_end.push_back(stream_frames - 1 - w % (stream_frames - frames + 1));
  const TaxelDropout dropout{0.2, 99};
  FlatParameters reference{table, parameters, std::vector<double>(table.size())};
  const auto trace =
      conv_stack_reference("object", shape, reference,
                           tactile_window_reference(shape.windows, stream, window_end, dropout));

  const Weights weights{table, upload(runtime, parameters),
                        runtime.allocate_zeros<float>(table.size())};
  ConvStack encoder(runtime, "object", shape, weights);
  encoder.prepare();
  encoder.forward(upload(runtime, stream), runtime.upload<int>(window_end), dropout);
  const auto features_shape = shape.features();
  const auto in_blocks = [&](const std::vector<double>& features) {
    return in_block_order(features, features_shape.channels,
                          features_shape.rows * features_shape.cols);
  };
  ASSERT_EQ(features_shape.row_size(), trace.layers[3].size());
  EXPECT_LE(norm_error(download(runtime, encoder.features()), in_blocks(trace.layers[3])), 2e-6);

  const auto grad_features = normal_floats(trace.layers[3].size(), "gradient");
  const auto in_rows = in_blocks(grad_features);
  runtime.write<float>(encoder.grad_features(), std::vector<float>(in_rows.begin(), in_rows.end()));
  encoder.backward();
  conv_stack_backward_reference(trace, grad_features, reference);
  EXPECT_LE(norm_error(download(runtime, weights.gradient), reference.gradient), 5e-5);

  encoder.backward();  // adds
  for (auto& value : reference.gradient) value *= 2;
  EXPECT_LE(norm_error(download(runtime, weights.gradient), reference.gradient), 5e-5);
}

std::string name_of(const ::testing::TestParamInfo<ConvStackShape>& info) {
  const auto& [w, kernel, strides, live] = info.param;
  return fmt::format("{}x{}x{}x{}_by_{}_of_{}{}{}", w.windows, w.frames, w.rows, w.cols, kernel,
                     strides[0], strides[1], strides[2]);
}

INSTANTIATE_TEST_SUITE_P(Shapes, ConvStackOfShape,
                         ::testing::Values(ConvStackShape{{3, 10, 32, 32}},
                                           ConvStackShape{{3, 1, 6, 6}},
                                           ConvStackShape{{3, 32, 8, 12}},
                                           ConvStackShape{{3, 3, 7, 13}},
                                           ConvStackShape{{201, 2, 16, 16}},
                                           ConvStackShape{{35, 10, 6, 6}, 3, {1, 1, 1}},
                                           ConvStackShape{{3, 4, 13, 7}, 3, {2, 1, 2}},
                                           ConvStackShape{{3, 2, 7, 6}, 5, {1, 2, 1}}),
                         name_of);

/// Features and gradient of 45 windows of ten frames.
std::pair<std::vector<float>, std::vector<float>> run_passes(const std::vector<double>& stream,
                                                             const LiveTaxels& live = {}) {
  Runtime runtime(choose_device(""));
  ConvStackShape shape{{45, 10, 32, 32}};
  shape.live = live;
  EXPECT_EQ(shape.layers()[0].dead.size(), live.empty() ? 0u : 9u * 9u);
  ParameterTable table;
  ConvStack::declare("tactile", shape, table);
  const Weights weights{table, runtime.upload<float>(table.initial_values(1)),
                        runtime.allocate_zeros<float>(table.size())};
  ConvStack encoder(runtime, "tactile", shape, weights);
  std::vector<int> window_end(45);
  std::iota(window_end.begin(), window_end.end(), 9);
  encoder.prepare();
  encoder.forward(upload(runtime, stream), runtime.upload<int>(window_end), {0.2, 5});
  runtime.write<float>(encoder.grad_features(), runtime.download(encoder.features()));
  encoder.backward();
  return {runtime.download(encoder.features()), runtime.download(weights.gradient)};
}

TEST(ConvStack, IsReproducible) {
  const auto stream = normal_floats(54 * 32 * 32, "stream");
  EXPECT_EQ(run_passes(stream), run_passes(stream));
}

TEST(ConvStack, SkippingDeadTaxelsDoesNotChangeTheResult) {
  auto stream = normal_floats(54 * 32 * 32, "stream");
  for (std::size_t i = 0; i < stream.size(); ++i)
    if (i / 32 % 32 >= 12 && i % 32 >= 13) stream[i] = 0.0;
  const auto live = live_taxels(std::vector<float>(stream.begin(), stream.end()), 32 * 32);
  EXPECT_EQ(run_passes(stream, live), run_passes(stream));
}

TEST(ConvStack, RejectsInvalidSizes) {
  for (const TactileWindowShape& window :
       {TactileWindowShape{1, 10, 0, 32}, {1, 10, 32, 65}, {1, 0, 32, 32}, {1, 33, 32, 32}}) {
    ParameterTable table;
    EXPECT_THROW(ConvStack::declare("tactile", {window}, table), Error);
  }
}

TEST(TaxelDropout, ZeroesItsFractionAndKeepsTheMean) {
  const TactileWindowShape shape{64, 1, 32, 32};
  const std::vector<double> ones(32 * 32, 1.0);
  const auto out = tactile_window_reference(shape, ones, std::vector<int>(64, 0), {0.2, 123});
  const double blanked = static_cast<double>(std::ranges::count(out, 0.0)) / out.size();
  EXPECT_NEAR(blanked, 0.2, 4 * std::sqrt(0.2 * 0.8 / out.size()));
  EXPECT_NEAR(std::accumulate(out.begin(), out.end(), 0.0) / out.size(), 1.0, 0.02);
}

}  // namespace
}  // namespace touchtrace
