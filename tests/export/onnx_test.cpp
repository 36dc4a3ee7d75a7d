#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/train/noise_batch.h"
#include "pipeline/export/export.h"
#include "pipeline/export/onnx_graph.h"
#include "pipeline/study/model_card.h"
#include "tests/engine/trainer_fixture.h"
#include "tests/export/python.h"

namespace touchtrace {
namespace {

using nlohmann::json;
using testing::run_script;
using testing::small_spec;
using testing::with_gru;

std::string bytes_of_text(std::initializer_list<int> bytes) { return {bytes.begin(), bytes.end()}; }

/// Examples of protobuf.dev/programming-guides/encoding, and -2 as the guide describes it.
TEST(Protobuf, EncodesTheExamplesOfItsGuide) {
  ProtobufWriter integer, text, nested, number, negative;
  integer.add(1, std::int64_t{150});
  EXPECT_EQ(integer.bytes(), bytes_of_text({0x08, 0x96, 0x01}));
  text.add(2, "testing");
  EXPECT_EQ(text.bytes(), "\x12\x07testing");
  nested.add(3, integer.bytes());
  EXPECT_EQ(nested.bytes(), bytes_of_text({0x1a, 0x03, 0x08, 0x96, 0x01}));
  number.add(2, 1.0f);
  EXPECT_EQ(number.bytes(), bytes_of_text({0x15, 0, 0, 0x80, 0x3f}));
  negative.add(1, std::int64_t{-2});
  EXPECT_EQ(negative.bytes(),
            bytes_of_text({0x08, 0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01}));
}

/// Bytes that onnx 1.23.2 (PyPI) serializes for the same model: onnx.helper.make_model of a graph
/// with one Flatten.
TEST(OnnxGraph, HasTheBytesOfTheOnnxPackage) {
  OnnxGraph graph("g");
  graph.add_node("Flatten", {"x"}, "y", {{"axis", std::int64_t{1}}});
  graph.add_constant("c", {2}, std::array{1.0f, -2.0f});
  graph.add_input("x", {"N", 3}, "in");
  graph.add_output("y", {"N", 3}, "out");
  const std::string model = graph.model({{"k", "v"}});
  std::string hex;
  for (const char byte : model) hex += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  EXPECT_EQ(hex,
            "0808120a746f75636874726163651a05302e312e303a740a270a01781201791a09792e466c617474"
            "656e2207466c617474656e2a0b0a04617869731801a001021201672a11080210014201634a080000"
            "803f000000c05a180a0178120f0a0d080112090a0312014e0a0208031a02696e62190a0179120f0a"
            "0d080112090a0312014e0a0208031a036f757442040a00101172060a016b120176");
}

/// A model of `touchtrace train`, a few updates old, and a roll-out of it.
class OnnxModel : public testing::TrainerTest {
 protected:
  static constexpr int sequences = 3, steps = 20, frames = 60;

  void make(ModelSpec spec) {
    spec.state = state_size;
    spec_ = spec;
    testing::NoiseRun run(runtime_, spec);
    if (spec.object == ObjectEncoder::frozen) {
      RandomStream random(4, "objects");
      run.trainer.freeze_objects(noise_objects(spec, random));
    }
    run.train_until(3);
    study::ModelCard card;
    card.spec = spec;
    for (int d = 0; d < state_size; ++d)
      card.scaling.mean[d] = 0.25f * static_cast<float>(d) - 1.0f,
      card.scaling.sigma[d] = 0.05f + 0.01f * static_cast<float>(d);
    scaling_ = card.scaling;
    run.trainer.save(folder_ / "model.safetensors", card, true);
    RandomStream random(3, "roll-out");
    stream_ = noise_stream(spec, frames, random);
    batch_ = noise_batch(spec, sequences, steps, frames, random);
    for (float& value : stream_) value = std::clamp(0.5f + 0.25f * value, 0.0f, 1.0f);
  }

  std::vector<float> in_metres(std::vector<float> values, bool is_width) const {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t d = i % state_size;
      values[i] = values[i] * scaling_.sigma[d] + (is_width ? 0.0f : scaling_.mean[d]);
    }
    return values;
  }

  /// Rolls out in Python.
  json roll_out(const std::string& engine, const std::string& model) {
    write_file(folder_ / "stream.bin",
               {reinterpret_cast<const char*>(stream_.data()), 4 * stream_.size()}, true);
    const auto metres = in_metres(batch_.initial_state, false);
    json state = json::array();
    for (int s = 0; s < sequences; ++s)
      state.push_back(std::vector<float>(metres.begin() + s * state_size,
                                         metres.begin() + (s + 1) * state_size));
    const json roll_out_case{{"model", (folder_ / model).string()},
                             {"object", (folder_ / "model.object.onnx").string()},
                             {"stream", (folder_ / "stream.bin").string()},
                             {"rows", spec_.rows},
                             {"cols", spec_.cols},
                             {"window", spec_.window_frames},
                             {"segment", spec_.segment_frames},
                             {"hidden", spec_.hidden},
                             {"first_frame", batch_.first_frame},
                             {"segment_frame", batch_.segment_frame},
                             {"state", state},
                             {"steps", steps}};
    write_file(folder_ / "case.json", roll_out_case.dump(), true);
    const auto result = run_script("roll_out.py", engine + " " + (folder_ / "case.json").string());
    const auto parsed = json::parse(result.output, nullptr, false);
    EXPECT_TRUE(result.status == 0 && parsed.is_object()) << result.output;
    return parsed;
  }

  /// Compares with the engine. Rounding to float32 has relative errors of up to 6e-8. A step has
  /// about 16 operations one after another; that all of their errors add up, twice over because of
  /// fast convolutions, gives 2e-6. The relative distances found are below 7e-7.
  void expect_engine(const json& python) {
    const auto rollout =
        Predictor(runtime_, folder_ / "model.safetensors").predict(batch_, stream_);
    expect_close(python["state"], rollout.state, true);
    expect_close(python["half_width"], rollout.spread, false);
  }

  void expect_close(const json& python, const std::vector<float>& scaled, bool is_state) {
    const auto values = python.get<std::vector<double>>();
    ASSERT_EQ(values.size(), scaled.size());
    double error = 0.0, size = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t d = i % state_size;
      const double value =
          (values[i] - (is_state ? double(scaling_.mean[d]) : 0.0)) / scaling_.sigma[d];
      error += std::pow(value - scaled[i], 2.0), size += std::pow(scaled[i], 2.0);
    }
    const double relative = std::sqrt(error / size);
    RecordProperty(is_state ? "state_distance" : "half_width_distance",
                   fmt::format("{:.2g}", relative));
    EXPECT_GT(size, 1.0);
    EXPECT_LE(relative, 2e-6);
    EXPECT_TRUE(std::isfinite(relative));
  }

  void export_model() {
    export_file("onnx", {FileKind::model, folder_ / "model.safetensors", folder_ / "model.onnx"});
  }

  ModelSpec spec_;
  Normalization scaling_;
  std::vector<float> stream_;
  RolloutBatch batch_;
};

struct OnnxCase {
  const char* name;
  ModelSpec spec;
};

/// Name in the output of a test.
void PrintTo(const OnnxCase& tested, std::ostream* out) { *out << tested.name; }

ModelSpec with_activation(Activation activation) {
  auto spec = small_spec(true);
  spec.activation = activation;
  return spec;
}

ModelSpec one_frame() {
  auto spec = small_spec(true);
  spec.window_frames = 1;
  return spec;
}

const std::vector<OnnxCase>& onnx_cases() {
  static const std::vector<OnnxCase> cases{
      {"touch", small_spec(true)},
      {"no_touch", small_spec(false)},
      {"gru", with_gru(small_spec(true))},
      {"gru_without_touch", with_gru(small_spec(false))},
      {"object", small_spec(ObjectEncoder::joint)},
      {"gru_with_object", with_gru(small_spec(ObjectEncoder::joint))},
      {"kernel_5", small_spec(5, {2, 1, 2})},
      {"silu", with_activation(Activation::silu)},
      {"tanh", with_activation(Activation::tanh)},
      {"one_frame", one_frame()}};
  return cases;
}

class OnnxCases : public OnnxModel, public ::testing::WithParamInterface<OnnxCase> {};

TEST_P(OnnxCases, NumpyGivesTheStatesOfTheEngine) {
  make(GetParam().spec);
  export_model();
  expect_engine(roll_out("numpy", "model.onnx"));
}

TEST_P(OnnxCases, OnnxruntimeGivesTheStatesOfTheEngine) {
  SKIP_WITHOUT_MODULES("onnxruntime, onnx");
  make(GetParam().spec);
  export_model();
  const auto check = testing::run_python(
      "-c 'import onnx, sys; onnx.checker.check_model(sys.argv[1], full_check=True)' " +
      (folder_ / "model.onnx").string());
  EXPECT_EQ(check.status, 0) << check.output;
  expect_engine(roll_out("onnxruntime", "model.onnx"));
}

TEST_P(OnnxCases, TorchGivesTheStatesOfTheEngine) {
  SKIP_WITHOUT_MODULES("torch");
  make(GetParam().spec);
  expect_engine(roll_out("torch", "model.safetensors"));
}

INSTANTIATE_TEST_SUITE_P(Models, OnnxCases, ::testing::ValuesIn(onnx_cases()),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST_F(OnnxModel, RefusesAFileWithoutAModelCard) {
  testing::NoiseRun run(runtime_, small_spec(true));
  run.trainer.save(folder_ / "model.safetensors", {{"made", "here"}}, true);
  EXPECT_THROW(export_model(), Error);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "model.onnx"));
}

}  // namespace
}  // namespace touchtrace
