#include "engine/train/touch_embedder.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "engine/base/error.h"
#include "engine/train/distinct_windows.h"
#include "engine/train/weight_file.h"

namespace touchtrace {
namespace {

// Windows go through the device in blocks of this size at most, so that memory stays bounded.
constexpr std::size_t block_windows = 256;

TactileEncoderShape shape_of(const std::string& encoder, const ModelSpec& spec) {
  return encoder == "object" ? segment_encoder(spec, 1) : window_encoder(spec, 1);
}

ParameterTable parameters_of(const std::string& encoder, const ModelSpec& spec) {
  ParameterTable table;
  TouchEncoder::declare(encoder, shape_of(encoder, spec), spec.embedding, table);
  return table;
}

}  // namespace

TouchEmbedder::TouchEmbedder(Runtime& runtime, const std::string& name, const ModelSpec& spec,
                             const TensorFile& weights)
    : runtime_(runtime),
      name_(name),
      shape_(shape_of(name, spec)),
      table_(parameters_of(name, spec)),
      weights_(allocate_weights(runtime, table_, false)),
      embedding_(spec.embedding) {
  runtime.write<float>(weights_.values, values_of(table_, weights));
}

void TouchEmbedder::fit(int windows) {
  if (windows == windows_) return;
  windows_ = windows;
  auto shape = shape_;
  shape.windows.windows = windows;
  encoder_ = std::make_unique<TouchEncoder>(runtime_, name_, shape, weights_);
  encoder_->prepare();
}

void TouchEmbedder::check(const Buffer<float>& stream,
                          std::span<const std::int32_t> last_frame) const {
  const auto& window = shape_.windows;
  const auto frames =
      static_cast<std::int32_t>(stream.size() / (std::size_t(window.rows) * window.cols));
  for (const auto last : last_frame)
    if (last + 1 < window.frames || last >= frames)
      throw data_error(fmt::format("{} frames up to frame {} do not lie in the tactile stream of "
                                   "{}",
                                   window.frames, last, frames),
                       "use a longer recording or fewer steps");
}

std::vector<float> TouchEmbedder::embed(const Buffer<float>& stream,
                                        std::span<const std::int32_t> last_frame) {
  check(stream, last_frame);
  std::vector<float> embeddings;
  if (last_frame.empty()) return embeddings;
  fit(static_cast<int>(std::min(last_frame.size(), block_windows)));
  for (std::size_t i = 0; i < last_frame.size(); i += windows_) {
    const auto count = std::min<std::size_t>(windows_, last_frame.size() - i);
    std::vector<std::int32_t> block(windows_, last_frame.back());
    std::ranges::copy(last_frame.subspan(i, count), block.begin());
    runtime_.write<std::int32_t>(encoder_->last_frame(), block);
    encoder_->forward(stream, {});
    const auto rows = runtime_.download(encoder_->embedding());
    std::copy_n(rows.begin(), count * embedding_, std::back_inserter(embeddings));
  }
  return embeddings;
}

TouchEmbeddings TouchEmbedder::embed_distinct(std::span<const float> tactile,
                                              const Buffer<float>& stream,
                                              std::span<const std::int32_t> last_frame) {
  check(stream, last_frame);
  auto windows = distinct_windows(tactile, shape_.windows, last_frame);
  return {std::move(windows.row), embed(stream, windows.last_frame)};
}

}  // namespace touchtrace
