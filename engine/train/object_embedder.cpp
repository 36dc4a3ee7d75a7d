#include "engine/train/object_embedder.h"

#include <algorithm>

#include "engine/train/segment_rows.h"
#include "engine/train/weight_file.h"

namespace touchtrace {
namespace {

// Segments go through the device in blocks of this size, so that memory stays bounded.
constexpr int block_segments = 16;

}  // namespace

ObjectEmbedder::ObjectEmbedder(Runtime& runtime, const ModelSpec& spec, const TensorFile& weights)
    : runtime_(runtime),
      spec_(spec),
      model_(runtime, spec, block_segments, ObjectModel::Use::prediction) {
  runtime.write<float>(model_.weights().values, values_of(model_.table(), weights));
  model_.prepare();
}

std::vector<float> ObjectEmbedder::embed(const Buffer<float>& stream,
                                         std::span<const std::int32_t> first_frame) {
  check_segments(spec_, first_frame, stream.size() / (std::size_t(spec_.rows) * spec_.cols));
  auto last_frame = segment_last_frames(spec_, first_frame);
  const auto count = last_frame.size();
  std::vector<float> embeddings;
  if (count == 0) return embeddings;
  last_frame.resize((count + block_segments - 1) / block_segments * block_segments,
                    last_frame.back());
  for (std::size_t i = 0; i < count; i += block_segments) {
    runtime_.write<std::int32_t>(model_.last_frame(),
                                 std::span(last_frame).subspan(i, block_segments));
    model_.forward(stream);
    std::ranges::copy(runtime_.download(model_.embedding()), std::back_inserter(embeddings));
  }
  embeddings.resize(count * spec_.embedding);
  return embeddings;
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
