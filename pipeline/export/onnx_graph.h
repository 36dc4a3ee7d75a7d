#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/protobuf_writer.h"

namespace touchtrace {

/// Builder of an ONNX model with one graph of float32 tensors (onnx/onnx.proto of
/// github.com/onnx/onnx, IR version 8, operator set 17). Nodes must be added in the order of their
/// evaluation.
class OnnxGraph {
 public:
  /// Extent of an axis, or its name if it may have any.
  using Extent = std::variant<std::int64_t, std::string>;
  using Attribute = std::variant<std::int64_t, float, std::vector<std::int64_t>>;
  using Attributes = std::map<std::string, Attribute>;

  explicit OnnxGraph(std::string name) : name_(std::move(name)) {}

  /// Each returns the name of the value.
  std::string add_input(const std::string& name, const std::vector<Extent>& shape,
                        const std::string& description);
  std::string add_constant(const std::string& name, const std::vector<std::int64_t>& shape,
                           std::span<const float> values);
  std::string add_constant(const std::string& name, const std::vector<std::int64_t>& integers);
  std::string add_node(const std::string& operation, const std::vector<std::string>& inputs,
                       const std::string& output, const Attributes& attributes = {});
  /// Splits the columns of `input` [N, columns] into parts of equal size.
  void add_split(const std::string& input, const std::vector<std::string>& outputs);
  /// Declares a value of the graph as an output.
  void add_output(const std::string& name, const std::vector<Extent>& shape,
                  const std::string& description);

  /// The file: ModelProto with `metadata` as metadata_props.
  std::string model(const std::map<std::string, std::string>& metadata) const;

 private:
  void write_node(const std::string& operation, const std::vector<std::string>& inputs,
                  const std::vector<std::string>& outputs, const Attributes& attributes);

  std::string name_;
  ProtobufWriter nodes_, constants_, inputs_, outputs_;  ///< fields of GraphProto
};

}  // namespace touchtrace
