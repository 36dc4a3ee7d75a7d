#include "tests/engine/step/problem.h"

#include <nlohmann/json.hpp>

namespace touchtrace::testing {
namespace {

/// A tensor of the file, split into slices of equal size; empty slices if it does not exist.
class SplitTensor {
 public:
  SplitTensor(const TensorFile& file, const std::string& name, std::size_t count) : count_(count) {
    for (const auto& tensor : file.tensors)
      if (tensor.name == name) values_ = tensor.values;
  }
  template <class T = float>
  std::vector<T> slice(std::size_t number) const {
    const auto size = static_cast<std::ptrdiff_t>(values_.size() / count_);
    const auto begin = values_.begin() + static_cast<std::ptrdiff_t>(number) * size;
    return {begin, begin + size};
  }
  std::size_t size() const { return values_.size(); }

 private:
  std::size_t count_;
  std::vector<float> values_;
};

TrainOptions options_of(const TensorFile& file) {
  TrainOptions options;
  const auto found = file.metadata.find("options");
  if (found == file.metadata.end()) return options;
  const auto json = nlohmann::json::parse(found->second);
  options.updates = json.value("updates", options.updates);
  options.learning_rate = json.value("learning_rate", options.learning_rate);
  options.weight_decay = json.value("weight_decay", options.weight_decay);
  options.object_loss = json.value("object_loss", options.object_loss);
  options.seed = json.value("seed", options.seed);
  return options;
}

std::vector<RolloutBatch> batches_of(const TensorFile& file, int state) {
  const int sequences = std::stoi(file.metadata.at("sequences")),
            steps = std::stoi(file.metadata.at("steps"));
  const std::size_t count =
      SplitTensor(file, "initial_state", 1).size() / (std::size_t(sequences) * state);
  const SplitTensor first_frame(file, "first_frame", count), initial(file, "initial_state", count),
      target(file, "target", count), weight(file, "weight", count), object(file, "object", count),
      segment_frame(file, "segment_frame", count);
  std::vector<RolloutBatch> batches;
  for (std::size_t i = 0; i < count; ++i)
    batches.push_back({.sequences = sequences,
                       .steps = steps,
                       .first_frame = first_frame.slice<std::int32_t>(i),
                       .initial_state = initial.slice(i),
                       .target = target.slice(i),
                       .weight = weight.slice(i),
                       .object = object.slice<std::int32_t>(i),
                       .segment_frame = segment_frame.slice<std::int32_t>(i)});
  return batches;
}

}  // namespace

Problem read_problem(const std::string& path) {
  Problem p{read_safetensors(path), {}, {}, {}, {}};
  p.spec = nlohmann::json::parse(p.file.metadata.at("spec")).get<ModelSpec>();
  p.options = options_of(p.file);
  p.batches = batches_of(p.file, p.spec.state);
  p.stream = SplitTensor(p.file, "stream", 1).slice(0);
  return p;
}

}  // namespace touchtrace::testing
