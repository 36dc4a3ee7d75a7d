#include "pipeline/export/onnx_graph.h"

#include "engine/base/version.h"

namespace touchtrace {
namespace {

// Numbers of fields and of types in onnx.proto.
namespace model_field {
constexpr int ir_version = 1, producer_name = 2, producer_version = 3, graph = 7, opset = 8,
              metadata = 14;
}
namespace graph_field {
constexpr int node = 1, name = 2, initializer = 5, input = 11, output = 12;
}
constexpr std::int64_t ir_version = 8, operator_set = 17;
constexpr std::int64_t float_type = 1, int64_type = 7;

ProtobufWriter tensor(const std::string& name, const std::vector<std::int64_t>& shape,
                      std::int64_t type, std::string_view values) {
  ProtobufWriter message;
  for (const std::int64_t extent : shape) message.add(1, extent);
  message.add(2, type);
  message.add(8, name);
  message.add(9, values);  // raw_data
  return message;
}

ProtobufWriter value_info(const std::string& name, const std::vector<OnnxGraph::Extent>& shape,
                          const std::string& description) {
  ProtobufWriter dimensions, tensor_type, type, message;
  for (const auto& extent : shape) {
    ProtobufWriter dimension;
    if (const auto* number = std::get_if<std::int64_t>(&extent))
      dimension.add(1, *number);
    else
      dimension.add(2, std::get<std::string>(extent));
    dimensions.add(1, dimension.bytes());
  }
  tensor_type.add(1, float_type);
  tensor_type.add(2, dimensions.bytes());
  type.add(1, tensor_type.bytes());
  message.add(1, name);
  message.add(2, type.bytes());
  message.add(3, description);
  return message;
}

// Values of AttributeProto: number of its field, and its type.
void add_value(ProtobufWriter& message, std::int64_t value) {
  message.add(3, value);
  message.add(20, std::int64_t{2});
}
void add_value(ProtobufWriter& message, float value) {
  message.add(2, value);
  message.add(20, std::int64_t{1});
}
void add_value(ProtobufWriter& message, const std::vector<std::int64_t>& values) {
  for (const std::int64_t value : values) message.add(8, value);
  message.add(20, std::int64_t{7});
}

ProtobufWriter attribute(const std::string& name, const OnnxGraph::Attribute& value) {
  ProtobufWriter message;
  message.add(1, name);
  std::visit([&](const auto& v) { add_value(message, v); }, value);
  return message;
}

}  // namespace

std::string OnnxGraph::add_input(const std::string& name, const std::vector<Extent>& shape,
                                 const std::string& description) {
  inputs_.add(graph_field::input, value_info(name, shape, description).bytes());
  return name;
}

void OnnxGraph::add_output(const std::string& name, const std::vector<Extent>& shape,
                           const std::string& description) {
  outputs_.add(graph_field::output, value_info(name, shape, description).bytes());
}

std::string OnnxGraph::add_constant(const std::string& name, const std::vector<std::int64_t>& shape,
                                    std::span<const float> values) {
  const std::string_view bytes(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  constants_.add(graph_field::initializer, tensor(name, shape, float_type, bytes).bytes());
  return name;
}

std::string OnnxGraph::add_constant(const std::string& name,
                                    const std::vector<std::int64_t>& integers) {
  const std::string_view bytes(reinterpret_cast<const char*>(integers.data()),
                               integers.size() * sizeof(std::int64_t));
  constants_.add(
      graph_field::initializer,
      tensor(name, {static_cast<std::int64_t>(integers.size())}, int64_type, bytes).bytes());
  return name;
}

void OnnxGraph::write_node(const std::string& operation, const std::vector<std::string>& inputs,
                           const std::vector<std::string>& outputs, const Attributes& attributes) {
  ProtobufWriter node;
  for (const auto& input : inputs) node.add(1, input);
  for (const auto& output : outputs) node.add(2, output);
  node.add(3, outputs.front() + "." + operation);
  node.add(4, operation);
  for (const auto& [name, value] : attributes) node.add(5, attribute(name, value).bytes());
  nodes_.add(graph_field::node, node.bytes());
}

std::string OnnxGraph::add_node(const std::string& operation,
                                const std::vector<std::string>& inputs, const std::string& output,
                                const Attributes& attributes) {
  write_node(operation, inputs, {output}, attributes);
  return output;
}

void OnnxGraph::add_split(const std::string& input, const std::vector<std::string>& outputs) {
  write_node("Split", {input}, outputs, {{"axis", std::int64_t{1}}});
}

std::string OnnxGraph::model(const std::map<std::string, std::string>& metadata) const {
  ProtobufWriter name, opset, message;
  name.add(graph_field::name, name_);
  opset.add(1, "");  // the domain of the operators of ONNX
  opset.add(2, operator_set);
  message.add(model_field::ir_version, ir_version);
  message.add(model_field::producer_name, "touchtrace");
  message.add(model_field::producer_version, version);
  message.add(model_field::graph, nodes_.bytes() + name.bytes() + constants_.bytes() +
                                      inputs_.bytes() + outputs_.bytes());
  message.add(model_field::opset, opset.bytes());
  for (const auto& [key, value] : metadata) {
    ProtobufWriter entry;
    entry.add(1, key);
    entry.add(2, value);
    message.add(model_field::metadata, entry.bytes());
  }
  return message.bytes();
}

}  // namespace touchtrace
