#include "engine/train/tactile_embedder.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "engine/base/error.h"
#include "engine/train/distinct_windows.h"
#include "engine/train/weight_file.h"

namespace touchtrace {
namespace {

// Maximum number of windows on the device at a time; bounds memory.
constexpr std::size_t max_windows = 256;

ConvStackShape shape_of(const std::string& encoder, const ModelSpec& spec) {
  return encoder == "object" ? segment_encoder(spec, 1) : window_encoder(spec, 1);
}

ParameterTable parameters_of(const std::string& encoder, const ModelSpec& spec) {
  ParameterTable table;
  TactileEncoder::declare(encoder, shape_of(encoder, spec), spec.embedding, table);
  return table;
}

}  // namespace

TactileEmbedder::TactileEmbedder(Runtime& runtime, const std::string& name, const ModelSpec& spec,
                                 const TensorFile& weights)
    : runtime_(runtime),
      name_(name),
      shape_(shape_of(name, spec)),
      table_(parameters_of(name, spec)),
      weights_(allocate_weights(runtime, table_, false)),
      embedding_(spec.embedding) {
  runtime.write<float>(weights_.values, values_of(table_, weights));
}

void TactileEmbedder::resize(int windows) {
  if (windows == windows_) return;
  windows_ = windows;
  auto shape = shape_;
  shape.windows.windows = windows;
  encoder_ = std::make_unique<TactileEncoder>(runtime_, name_, shape, weights_);
  encoder_->prepare();
}

void TactileEmbedder::check(const Buffer<float>& stream,
                            std::span<const std::int32_t> window_end) const {
  const auto& window = shape_.windows;
  const auto frames =
      static_cast<std::int32_t>(stream.size() / (std::size_t(window.rows) * window.cols));
  for (const auto last : window_end)
    if (last + 1 < window.frames || last >= frames)
      throw data_error(fmt::format("window of {} frames up to frame {} is outside the tactile "
                                   "stream of {} frames",
                                   window.frames, last, frames),
                       "use a longer recording or fewer steps");
}

std::vector<float> TactileEmbedder::embed(const Buffer<float>& stream,
                                          std::span<const std::int32_t> window_end) {
  check(stream, window_end);
  std::vector<float> embeddings;
  if (window_end.empty()) return embeddings;
  resize(static_cast<int>(std::min(window_end.size(), max_windows)));
  for (std::size_t i = 0; i < window_end.size(); i += windows_) {
    const auto count = std::min<std::size_t>(windows_, window_end.size() - i);
    std::vector<std::int32_t> block(windows_, window_end.back());
    std::ranges::copy(window_end.subspan(i, count), block.begin());
    runtime_.write<std::int32_t>(encoder_->window_end(), block);
    encoder_->forward(stream, {});
    const auto rows = runtime_.download(encoder_->embedding());
    std::copy_n(rows.begin(), count * embedding_, std::back_inserter(embeddings));
  }
  return embeddings;
}

DistinctEmbeddings TactileEmbedder::embed_distinct(std::span<const float> tactile,
                                                   const Buffer<float>& stream,
                                                   std::span<const std::int32_t> window_end) {
  check(stream, window_end);
  auto windows = distinct_windows(tactile, shape_.windows, window_end);
  return {std::move(windows.row), embed(stream, windows.window_end)};
}

}  // namespace touchtrace
