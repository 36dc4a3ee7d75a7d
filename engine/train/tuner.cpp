#include "engine/train/tuner.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "engine/base/progress.h"
#include "engine/cl/timing.h"
#include "engine/model/tactile_encoder.h"
#include "engine/ops/conv2d_candidates.h"
#include "engine/train/encoder_trials.h"
#include "engine/train/layer_trials.h"
#include "engine/train/noise_training.h"

namespace touchtrace {
namespace {

// Ratios to the time of the default configuration. Below the first a variant is measured once more;
// it is taken if it is below the second then.
constexpr double max_candidate_ratio = 0.98, max_accepted_ratio = 0.99;
// Estimates for the progress display: variants per layer and per micro-batch size.
constexpr int layer_variants = 11, micro_batch_variants = 5;
// Enough that the work done once per update has about the weight that it has in an update.
constexpr int max_micro_batches = 5;

bool is_tuned(const Tuning& tuning, const Conv2dShape& layer) {
  const auto* tuned = tuning.layer(layer);
  return tuned && tuned->shape.images == layer.images;
}

/// Tuned micro-batch of exactly this encoder, or null.
const Tuning::MicroBatch* tuned_micro_batch(const Tuning& tuning, const ConvStackShape& encoder) {
  const auto first_layer = encoder.layers()[0];
  const auto* tuned = tuning.micro_batch(first_layer);
  return tuned && tuned->first_layer.images == first_layer.images ? tuned : nullptr;
}

int default_micro_batch(const ConvStackShape& encoder) {
  return std::min(encoder.windows.windows, ConvStack::micro_batch_windows);
}

int num_micro_batches(const ConvStackShape& encoder, int size) {
  return (encoder.windows.windows + size - 1) / size;
}

/// The default size first; then half and twice of it, for which Tuning::layer() still finds the
/// layers tuned for it; and the size that makes all micro-batches equal.
std::vector<int> micro_batch_candidates(const ConvStackShape& encoder) {
  constexpr int min_size = 8;
  const int windows = encoder.windows.windows, standard = default_micro_batch(encoder),
            count = num_micro_batches(encoder, standard);
  std::vector<int> sizes{standard};
  for (const int size : {standard / 2, (windows + count - 1) / count, 2 * standard})
    if (size >= min_size && size < windows && std::ranges::count(sizes, size) == 0)
      sizes.push_back(size);
  return sizes;
}

/// Ratios to the time of the first variant; infinite for unsupported variants.
std::vector<double> measure_ratios(Runtime& runtime,
                                   const std::vector<std::optional<Trial>>& variants) {
  std::vector<Trial> trials;
  for (const auto& variant : variants)
    if (variant) trials.push_back(*variant);
  const auto times = compare(runtime, trials);
  std::vector<double> ratios;
  auto time = times.begin();
  for (const auto& variant : variants)
    ratios.push_back(variant ? (time++)->ratio : std::numeric_limits<double>::infinity());
  return ratios;
}

/// Index of the smallest ratio in [begin, end) if it makes a candidate, else 0, the default.
std::size_t best_of(const std::vector<double>& ratios, std::size_t begin, std::size_t end) {
  if (begin == end) return 0;
  const auto best = std::min_element(ratios.begin() + begin, ratios.begin() + end);
  return *best < max_candidate_ratio ? static_cast<std::size_t>(best - ratios.begin()) : 0;
}

class Tuner {
 public:
  Tuner(Runtime& runtime, const std::vector<ConvStackShape>& encoders, Tuning& tuning,
        const std::function<void()>& on_result)
      : runtime_(runtime),
        tuning_(tuning),
        on_result_(on_result),
        progress_("tuning", variants_left(encoders)) {}

  void tune_encoder(const ConvStackShape& encoder) {
    tune_layers(encoder, default_micro_batch(encoder));
    if (!tuned_micro_batch(tuning_, encoder)) add(tune_micro_batch(encoder), micro_batch_variants);
    tune_layers(encoder, tuned_micro_batch(tuning_, encoder)->images);
  }

 private:
  std::uint64_t variants_left(const std::vector<ConvStackShape>& encoders) const {
    std::uint64_t variants = 0;
    for (const auto& encoder : encoders) {
      for (const auto& layer : encoder.of_windows(default_micro_batch(encoder)).layers())
        variants += is_tuned(tuning_, layer) ? 0 : layer_variants;
      variants += tuned_micro_batch(tuning_, encoder) ? 0 : micro_batch_variants;
    }
    return variants;
  }

  void tune_layers(const ConvStackShape& encoder, int micro_batch) {
    const int count = std::min(num_micro_batches(encoder, micro_batch), max_micro_batches);
    for (const auto& layer : encoder.of_windows(micro_batch).layers())
      if (!is_tuned(tuning_, layer)) add(tune_layer(layer, count), layer_variants);
  }

  Tuning::Layer tune_layer(const Conv2dShape& layer, int micro_batches) {
    LayerTrials trials(runtime_, layer, micro_batches);
    const auto standard = ConvStack::default_configuration(layer);
    const auto [products, gradients] = conv2d_candidates(runtime_, layer);
    std::vector<Conv2dChoice> choices{standard};
    for (const auto& choice : products)
      if (choice != standard) choices.push_back(choice);
    const auto first_gradient = choices.size();
    for (const auto& choice : gradients) choices.push_back(joined(standard, choice));
    const auto variants = build(choices, [&](const auto& choice) { return trials.make(choice); });
    const auto ratios = measure_ratios(runtime_, variants);
    const auto best = joined(choices[best_of(ratios, 1, first_gradient)],
                             choices[best_of(ratios, first_gradient, choices.size())]);
    if (best == standard) return {layer, standard, default_times(*variants.front())};
    const auto [accepted, times] = measure_again(*variants.front(), trials.make(best));
    return {layer, accepted ? best : standard, times};
  }

  Tuning::MicroBatch tune_micro_batch(const ConvStackShape& encoder) {
    EncoderTrials trials(runtime_, encoder);
    const auto first_layer = encoder.layers()[0];
    const auto sizes = micro_batch_candidates(encoder);
    const auto variants = build(sizes, [&](int size) {
      auto tuning = tuning_;
      tuning.set(Tuning::MicroBatch{first_layer, size});
      return trials.make(tuning);
    });
    const auto best = best_of(measure_ratios(runtime_, variants), 1, sizes.size());
    if (best == 0) return {first_layer, sizes.front(), default_times(*variants.front())};
    const auto [accepted, times] = measure_again(*variants.front(), variants[best]);
    return {first_layer, accepted ? sizes[best] : sizes.front(), times};
  }

  template <class Choice, class Make>
  std::vector<std::optional<Trial>> build(const std::vector<Choice>& choices, Make make) {
    std::vector<std::optional<Trial>> trials;
    for (const auto& choice : choices) {
      trials.push_back(make(choice));
      progress_.advance();
      ++counted_;
    }
    return trials;
  }

  TunedTimes default_times(const Trial& standard) {
    const double ms = compare(runtime_, {standard}).front().ms;
    return {ms, ms};
  }

  /// Whether the variant is accepted, and the times. The second measurement excludes variants that
  /// were fast by chance.
  std::pair<bool, TunedTimes> measure_again(const Trial& standard,
                                            const std::optional<Trial>& variant) {
    if (!variant) return {false, default_times(standard)};
    const auto times = compare(runtime_, {standard, *variant});
    const bool accepted = times[1].ratio < max_accepted_ratio;
    return {accepted, {times[0].ms, accepted ? times[1].ms : times[0].ms}};
  }

  template <class Row>
  void add(const Row& row, int variants) {
    tuning_.set(row);
    on_result_();
    progress_.advance(
        static_cast<std::uint64_t>(std::max(0, variants - std::exchange(counted_, 0))));
  }

  Runtime& runtime_;
  Tuning& tuning_;
  const std::function<void()>& on_result_;
  Progress progress_;
  int counted_ = 0;  ///< variants of the current shape that `progress_` has counted
};

}  // namespace

std::vector<ConvStackShape> training_encoders(const ModelSpec& spec, int sequences, int steps,
                                              int object_segments) {
  if (!spec.touch) return {};
  std::vector<ConvStackShape> encoders{window_encoder(spec, sequences * steps)};
  if (spec.object == ObjectEncoder::joint) encoders.push_back(segment_encoder(spec, sequences));
  if (spec.object == ObjectEncoder::frozen)
    encoders.push_back(segment_encoder(spec, object_segments));
  return encoders;
}

bool is_complete(const Tuning& tuning, const std::vector<ConvStackShape>& encoders) {
  return std::ranges::all_of(encoders, [&](const auto& encoder) {
    const auto* batch = tuned_micro_batch(tuning, encoder);
    return batch && std::ranges::all_of(encoder.of_windows(batch->images).layers(),
                                        [&](const auto& layer) { return is_tuned(tuning, layer); });
  });
}

void tune(Runtime& runtime, const std::vector<ConvStackShape>& encoders, Tuning& tuning,
          const std::function<void()>& on_result) {
  Tuner tuner(runtime, encoders, tuning, on_result);
  for (const auto& encoder : encoders) tuner.tune_encoder(encoder);
}

void reset_to_defaults(Tuning& tuning, const std::vector<ConvStackShape>& encoders) {
  for (const auto& encoder : encoders) {
    auto batch = *tuned_micro_batch(tuning, encoder);
    for (const int images : {default_micro_batch(encoder), batch.images})
      for (const auto& shape : encoder.of_windows(images).layers()) {
        auto layer = *tuning.layer(shape);
        layer.choice = ConvStack::default_configuration(shape);
        layer.times.tuned_ms = layer.times.default_ms;
        tuning.set(layer);
      }
    batch.images = default_micro_batch(encoder);
    batch.times.tuned_ms = batch.times.default_ms;
    tuning.set(batch);
  }
}

bool is_faster(const TunedTimes& updates) {
  return updates.tuned_ms < max_accepted_ratio * updates.default_ms;
}

TunedTimes measure_update_times(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                                const Tuning& tuning) {
  NoiseTraining by_default(runtime, spec, sequences, steps),
      tuned(runtime, spec, sequences, steps, tuning);
  std::vector<double> default_ms, tuned_ms;
  for (const auto& round :
       interleaved_seconds(runtime, {[&] { by_default.update(); }, [&] { tuned.update(); }}))
    default_ms.push_back(1e3 * round[0]), tuned_ms.push_back(1e3 * round[1]);
  return {median(default_ms), median(tuned_ms)};
}

}  // namespace touchtrace
