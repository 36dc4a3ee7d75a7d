#include "engine/train/object_embedder.h"

#include <algorithm>

#include "engine/train/segment_rows.h"

namespace touchtrace {

ObjectEmbedder::ObjectEmbedder(Runtime& runtime, const ModelSpec& spec, const TensorFile& weights)
    : spec_(spec), embedder_(runtime, "object", spec, weights) {}

std::vector<float> ObjectEmbedder::embed(const Buffer<float>& stream,
                                         std::span<const std::int32_t> first_frame) {
  check_segments(spec_, first_frame, stream.size() / (std::size_t(spec_.rows) * spec_.cols));
  return embedder_.embed(stream, segment_ends(spec_, first_frame));
}

std::vector<Tensor> object_encoder_of(TensorFile file) {
  std::erase_if(file.tensors,
                [](const Tensor& tensor) { return !tensor.name.starts_with("object."); });
  return std::move(file.tensors);
}

std::vector<float> mean_embeddings(std::span<const float> embeddings,
                                   std::span<const std::int32_t> object, int objects) {
  const auto size = embeddings.size() / object.size();
  std::vector<double> sums(size * objects, 0.0);
  for (std::size_t i = 0; i < embeddings.size(); ++i)
    sums[object[i / size] * size + i % size] += embeddings[i];
  std::vector<float> means;
  for (std::size_t i = 0; i < sums.size(); ++i)
    means.push_back(static_cast<float>(
        sums[i] / double(std::ranges::count(object, static_cast<std::int32_t>(i / size)))));
  return means;
}

}  // namespace touchtrace
