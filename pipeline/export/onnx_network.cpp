#include "pipeline/export/onnx_network.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/base/json_text.h"
#include "engine/model/dynamics.h"
#include "engine/model/tactile_encoder.h"
#include "engine/train/weight_file.h"
#include "pipeline/export/onnx_graph.h"

namespace touchtrace {
namespace {

using Extents = std::vector<OnnxGraph::Extent>;

constexpr float layer_norm_epsilon = 1e-5f;  // kernels/layer_norm.cl
constexpr float difference_gain = 5.0f;      // engine/ops/tactile_window.h
const std::string batch_axis = "N";

/// Graph of a network whose weights are constants with the names of the model file.
class NetworkGraph {
 public:
  NetworkGraph(const std::string& name, const ModelFile& model)
      : spec_(model.spec), model_(model), graph_(name) {}

  void add_weights(const ParameterTable& table) {
    for (Tensor& tensor : tensors_of(table, values_of(table, model_.file)))
      graph_.add_constant(tensor.name, {tensor.shape.begin(), tensor.shape.end()}, tensor.values);
  }

  /// Embedding [N, embedding] of `frames` tactile frames, by the encoder `name`.
  std::string add_encoder(const std::string& name, int frames) {
    std::string x = add_differences(add_touch(frames), frames);
    const std::int64_t kernel = spec_.tactile_kernel, padding = kernel / 2;
    for (std::size_t i = 0; i < spec_.tactile_strides.size(); ++i) {
      const std::string layer = fmt::format("{}.conv{}", name, i + 1);
      const std::int64_t stride = spec_.tactile_strides[i];
      x = graph_.add_node("Conv", {x, layer + ".weight", layer + ".bias"}, layer,
                          {{"kernel_shape", std::vector{kernel, kernel}},
                           {"pads", std::vector{padding, padding, padding, padding}},
                           {"strides", std::vector{stride, stride}}});
      x = graph_.add_node("Relu", {x}, layer + ".relu");
    }
    x = graph_.add_node("Flatten", {x}, name + ".flat");
    x = add_dense(x, name + ".dense.weight", name + ".dense.bias", name + ".dense");
    return graph_.add_node("LayerNormalization", {x, name + ".norm.weight", name + ".norm.bias"},
                           name + ".embedding",
                           {{"axis", std::int64_t{-1}}, {"epsilon", layer_norm_epsilon}});
  }

  std::string add_dense(const std::string& x, const std::string& weight, const std::string& bias,
                        const std::string& output) {
    return graph_.add_node("Gemm", {x, weight, bias}, output, {{"transB", std::int64_t{1}}});
  }

  OnnxGraph& graph() { return graph_; }
  const ModelSpec& spec() const { return spec_; }

  std::string bytes(const nlohmann::json& metadata) const {
    std::map<std::string, std::string> texts;
    for (const auto& [key, value] : metadata.items()) texts[key] = json_text(value);
    return graph_.model(texts);
  }

 private:
  std::string add_touch(int frames) {
    return graph_.add_input(
        "touch", {batch_axis, frames, spec_.rows, spec_.cols},
        "pressure from 0 to 1, oldest frame first, averaged by area to this resolution");
  }

  /// Frames first .. last of a window.
  std::string add_frames(const std::string& touch, const std::string& name, std::int64_t first,
                         std::int64_t last) {
    const auto begin = graph_.add_constant(name + ".begin", {first}),
               end = graph_.add_constant(name + ".end", {last + 1}),
               axis = graph_.add_constant(name + ".axis", {1});
    return graph_.add_node("Slice", {touch, begin, end, axis}, name);
  }

  /// The difference basis of tactile_window.h.
  std::string add_differences(const std::string& touch, int frames) {
    if (frames == 1) return touch;
    const auto newest = add_frames(touch, "newest", frames - 1, frames - 1);
    const auto later = add_frames(touch, "later", 1, frames - 1);
    const auto earlier = add_frames(touch, "earlier", 0, frames - 2);
    const auto gain = graph_.add_constant("gain", {}, std::array{difference_gain});
    const auto change = graph_.add_node("Sub", {later, earlier}, "change");
    const auto scaled = graph_.add_node("Mul", {change, gain}, "scaled_change");
    return graph_.add_node("Concat", {scaled, newest}, "window", {{"axis", std::int64_t{1}}});
  }

  ModelSpec spec_;
  const ModelFile& model_;
  OnnxGraph graph_;
};

ParameterTable step_parameters(const ModelSpec& spec) {
  ParameterTable table;
  if (spec.touch)
    TactileEncoder::declare("tactile", window_encoder(spec, 1), spec.embedding, table);
  declare_dynamics(spec, table);
  return table;
}

const char* onnx_activation(Activation activation) {
  return activation == Activation::relu ? "Relu" : "Tanh";
}

std::string add_activation(NetworkGraph& network, const std::string& x, const std::string& name) {
  const Activation activation = network.spec().activation;
  if (activation != Activation::silu)
    return network.graph().add_node(onnx_activation(activation), {x}, name);
  const auto gate = network.graph().add_node("Sigmoid", {x}, name + ".gate");
  return network.graph().add_node("Mul", {x, gate}, name);
}

/// Returns the last layer's output [N, 2 state]: change and band of the scaled state.
std::string add_mlp(NetworkGraph& network, std::string x) {
  for (const int layer : {0, 2, 4}) {
    const std::string name = fmt::format("dynamics.{}", layer);
    x = network.add_dense(x, name + ".weight", name + ".bias", name);
    if (layer < 4) x = add_activation(network, x, name + ".activation");
  }
  return x;
}

/// As add_mlp(). Gates in the order reset, update, new (dynamics_gru.h).
std::string add_gru(NetworkGraph& network, const std::string& x) {
  OnnxGraph& graph = network.graph();
  const Extents shape{batch_axis, network.spec().hidden};
  const auto h = graph.add_input("hidden", shape, "zeros at the start, then next_hidden");
  const std::string cell = "dynamics.cell.";
  const auto from_x = network.add_dense(x, cell + "weight_ih", cell + "bias_ih", "from_input"),
             from_h = network.add_dense(h, cell + "weight_hh", cell + "bias_hh", "from_hidden");
  graph.add_split(from_x, {"x_reset", "x_update", "x_new"});
  graph.add_split(from_h, {"h_reset", "h_update", "h_new"});
  const auto gate = [&](const std::string& name) {
    const auto sum = graph.add_node("Add", {"x_" + name, "h_" + name}, name + ".sum");
    return graph.add_node("Sigmoid", {sum}, name);
  };
  const auto reset = gate("reset"), update = gate("update");
  const auto kept = graph.add_node("Mul", {reset, "h_new"}, "kept");
  const auto sum = graph.add_node("Add", {"x_new", kept}, "new.sum");
  const auto fresh = graph.add_node("Tanh", {sum}, "new");
  const auto change = graph.add_node("Sub", {h, fresh}, "hidden_change");
  const auto scaled = graph.add_node("Mul", {update, change}, "scaled_hidden_change");
  const auto next = graph.add_node("Add", {fresh, scaled}, "next_hidden");
  graph.add_output(next, shape, "input `hidden` of the next step");
  return network.add_dense(next, "dynamics.out.weight", "dynamics.out.bias", "dynamics.out");
}

/// From the last layer's output to next_state and half_width in metres and m/s.
void add_outputs(NetworkGraph& network, const std::string& last, const std::string& scaled_state) {
  OnnxGraph& graph = network.graph();
  const Extents shape{batch_axis, network.spec().state};
  graph.add_split(last, {"change_of_state", "band"});
  const auto next = graph.add_node("Add", {scaled_state, "change_of_state"}, "scaled_next_state");
  const auto spread = graph.add_node("Softplus", {"band"}, "scaled_half_width");
  const auto metres = graph.add_node("Mul", {next, "sigma"}, "centred_next_state");
  graph.add_node("Add", {metres, "mean"}, "next_state");
  graph.add_node("Mul", {spread, "sigma"}, "half_width");
  graph.add_output("next_state", shape, "state of the next frame [m, m/s]");
  graph.add_output("half_width", shape,
                   "of the band, before the factors `band_scale` of the metadata [m, m/s]");
}

std::string add_scaled_state(NetworkGraph& network, const Normalization& scaling) {
  OnnxGraph& graph = network.graph();
  const auto state =
      graph.add_input("state", {batch_axis, network.spec().state},
                      "position [m] and velocity [m/s] of the object, then of the hand");
  graph.add_constant("mean", {state_size}, scaling.mean);
  graph.add_constant("sigma", {state_size}, scaling.sigma);
  const auto centred = graph.add_node("Sub", {state, "mean"}, "centred_state");
  return graph.add_node("Div", {centred, "sigma"}, "scaled_state");
}

}  // namespace

std::string step_onnx(const ModelFile& model, const Normalization& scaling) {
  const ModelSpec& spec = model.spec;
  if (spec.state != state_size)
    throw data_error(
        fmt::format("the model has {} state dimensions instead of {}", spec.state, state_size),
        "use a model that `touchtrace train` wrote");
  NetworkGraph network("step", model);
  network.add_weights(step_parameters(spec));
  const auto state = add_scaled_state(network, scaling);
  std::vector<std::string> inputs{state};
  if (spec.touch) inputs.push_back(network.add_encoder("tactile", spec.window_frames));
  if (spec.object != ObjectEncoder::none)
    inputs.push_back(network.graph().add_input("object", {batch_axis, spec.embedding},
                                               "output of the object encoder's file"));
  const auto x =
      network.graph().add_node("Concat", inputs, "dynamics.input", {{"axis", std::int64_t{1}}});
  add_outputs(network,
              spec.dynamics == DynamicsKind::gru ? add_gru(network, x) : add_mlp(network, x),
              state);
  return network.bytes(model.metadata);
}

std::string object_encoder_onnx(const ModelFile& model) {
  const ModelSpec& spec = model.spec;
  ParameterTable table;
  TactileEncoder::declare("object", segment_encoder(spec, 1), spec.embedding, table);
  NetworkGraph network("object_encoder", model);
  network.add_weights(table);
  const auto embedding = network.add_encoder("object", spec.segment_frames);
  network.graph().add_node("Identity", {embedding}, "object");
  network.graph().add_output("object", {batch_axis, spec.embedding},
                             "embedding of the object, an input of the step");
  return network.bytes(model.metadata);
}

}  // namespace touchtrace
