#include "engine/train/tuner.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "engine/base/integer_math.h"
#include "engine/base/progress.h"
#include "engine/cl/timing.h"
#include "engine/model/touch_encoder.h"
#include "engine/ops/conv2d_candidates.h"
#include "engine/train/encoder_trials.h"
#include "engine/train/layer_trials.h"
#include "engine/train/noise_training.h"

namespace touchtrace {
namespace {

// Ways that seem this much faster are measured once more, and taken if they are faster again.
constexpr double worth_a_look = 0.98, worth_it = 0.99;
// For the time left: ways that are built for a layer and for the size of parts.
constexpr int layer_ways = 11, part_ways = 5;
// So that what is done once an update counts as in an update, without taking forever.
constexpr int most_parts = 5;

bool is_known(const Tuning& tuning, const Conv2dShape& layer) {
  const auto* known = tuning.layer(layer);
  return known && known->shape.images == layer.images;
}

/// The tuned part of exactly this encoder.
const Tuning::Part* known_part(const Tuning& tuning, const TactileEncoderShape& encoder) {
  const auto first_layer = encoder.layers()[0];
  const auto* known = tuning.part(first_layer);
  return known && known->first_layer.images == first_layer.images ? known : nullptr;
}

int usual_part(const TactileEncoderShape& encoder) {
  return std::min(encoder.windows.windows, TactileEncoder::part_windows);
}

/// Half and twice the usual one, which tuned layers still serve, and parts of equal size.
std::vector<int> part_candidates(const TactileEncoderShape& encoder) {
  const int usual = usual_part(encoder), parts = ceil_div(encoder.windows.windows, usual);
  std::vector<int> sizes{usual};
  for (const int size : {usual / 2, ceil_div(encoder.windows.windows, parts), 2 * usual})
    if (size >= 8 && size < encoder.windows.windows && std::ranges::count(sizes, size) == 0)
      sizes.push_back(size);
  return sizes;
}

/// Ratios to the first trial's time; infinite for a way that is refused.
std::vector<double> ratios(Runtime& runtime, const std::vector<std::optional<Trial>>& ways) {
  std::vector<Trial> trials;
  for (const auto& way : ways)
    if (way) trials.push_back(*way);
  const auto times = compare(runtime, trials);
  std::vector<double> ratios;
  auto time = times.begin();
  for (const auto& way : ways)
    ratios.push_back(way ? (time++)->ratio : std::numeric_limits<double>::infinity());
  return ratios;
}

/// The place of the smallest ratio of [begin, end) if it is worth a second look, else 0.
std::size_t best_of(const std::vector<double>& ratios, std::size_t begin, std::size_t end) {
  if (begin == end) return 0;
  const auto best = std::min_element(ratios.begin() + begin, ratios.begin() + end);
  return *best < worth_a_look ? static_cast<std::size_t>(best - ratios.begin()) : 0;
}

class Tuner {
 public:
  Tuner(Runtime& runtime, const std::vector<TactileEncoderShape>& encoders, Tuning& tuning,
        const std::function<void()>& found)
      : runtime_(runtime),
        tuning_(tuning),
        found_(found),
        progress_("tuning", ways_left(encoders)) {}

  void tune_encoder(const TactileEncoderShape& encoder) {
    tune_layers(encoder, usual_part(encoder));
    if (!known_part(tuning_, encoder)) keep(tuned_part(encoder), part_ways);
    tune_layers(encoder, known_part(tuning_, encoder)->images);
  }

 private:
  std::uint64_t ways_left(const std::vector<TactileEncoderShape>& encoders) const {
    std::uint64_t ways = 0;
    for (const auto& encoder : encoders) {
      for (const auto& layer : encoder.of_windows(usual_part(encoder)).layers())
        ways += is_known(tuning_, layer) ? 0 : layer_ways;
      ways += known_part(tuning_, encoder) ? 0 : part_ways;
    }
    return ways;
  }

  void tune_layers(const TactileEncoderShape& encoder, int part) {
    const int parts = std::min(ceil_div(encoder.windows.windows, part), most_parts);
    for (const auto& layer : encoder.of_windows(part).layers())
      if (!is_known(tuning_, layer)) keep(tuned_layer(layer, parts), layer_ways);
  }

  Tuning::Layer tuned_layer(const Conv2dShape& layer, int parts) {
    LayerTrials trials(runtime_, layer, parts);
    const auto usual = TactileEncoder::usual_choice(layer);
    const auto [products, gradients] = conv2d_candidates(runtime_, layer);
    std::vector<Conv2dChoice> choices{usual};
    for (const auto& choice : products)
      if (choice != usual) choices.push_back(choice);
    const auto first_gradient = choices.size();
    for (const auto& choice : gradients) choices.push_back(joined(usual, choice));
    const auto ways = tried(choices, [&](const auto& choice) { return trials.make(choice); });
    const auto times = ratios(runtime_, ways);
    const auto best = joined(choices[best_of(times, 1, first_gradient)],
                             choices[best_of(times, first_gradient, choices.size())]);
    if (best == usual) return {layer, usual, usual_times(*ways.front())};
    const auto [taken, both] = second_look(*ways.front(), trials.make(best));
    return {layer, taken ? best : usual, both};
  }

  Tuning::Part tuned_part(const TactileEncoderShape& encoder) {
    EncoderTrials trials(runtime_, encoder);
    const auto first_layer = encoder.layers()[0];
    const auto sizes = part_candidates(encoder);
    const auto ways = tried(sizes, [&](int size) {
      auto tuning = tuning_;
      tuning.set(Tuning::Part{first_layer, size});
      return trials.make(tuning);
    });
    const auto best = best_of(ratios(runtime_, ways), 1, sizes.size());
    if (best == 0) return {first_layer, sizes.front(), usual_times(*ways.front())};
    const auto [taken, both] = second_look(*ways.front(), ways[best]);
    return {first_layer, taken ? sizes[best] : sizes.front(), both};
  }

  template <class Way, class Make>
  std::vector<std::optional<Trial>> tried(const std::vector<Way>& ways, Make make) {
    std::vector<std::optional<Trial>> trials;
    for (const auto& way : ways) {
      trials.push_back(make(way));
      progress_.advance();
      ++counted_;
    }
    return trials;
  }

  TunedTimes usual_times(const Trial& usual) {
    const double ms = compare(runtime_, {usual}).front().ms;
    return {ms, ms};
  }

  /// Whether the way is taken, and the times of that: a way that was lucky once is not twice.
  std::pair<bool, TunedTimes> second_look(const Trial& usual, const std::optional<Trial>& way) {
    if (!way) return {false, usual_times(usual)};
    const auto times = compare(runtime_, {usual, *way});
    const bool taken = times[1].ratio < worth_it;
    return {taken, {times[0].ms, taken ? times[1].ms : times[0].ms}};
  }

  template <class Row>
  void keep(const Row& row, int ways) {
    tuning_.set(row);
    found_();
    progress_.advance(static_cast<std::uint64_t>(std::max(0, ways - std::exchange(counted_, 0))));
  }

  Runtime& runtime_;
  Tuning& tuning_;
  const std::function<void()>& found_;
  Progress progress_;
  int counted_ = 0;  ///< ways of the present shape that progress knows of
};

}  // namespace

std::vector<TactileEncoderShape> encoders_in_training(const ModelSpec& spec, int sequences,
                                                      int steps, int object_segments) {
  if (!spec.touch) return {};
  std::vector<TactileEncoderShape> encoders{window_encoder(spec, sequences * steps)};
  if (spec.object == ObjectEncoder::joint) encoders.push_back(segment_encoder(spec, sequences));
  if (spec.object == ObjectEncoder::frozen)
    encoders.push_back(segment_encoder(spec, object_segments));
  return encoders;
}

bool is_complete(const Tuning& tuning, const std::vector<TactileEncoderShape>& encoders) {
  return std::ranges::all_of(encoders, [&](const auto& encoder) {
    const auto* part = known_part(tuning, encoder);
    return part && std::ranges::all_of(encoder.of_windows(part->images).layers(),
                                       [&](const auto& layer) { return is_known(tuning, layer); });
  });
}

void tune(Runtime& runtime, const std::vector<TactileEncoderShape>& encoders, Tuning& tuning,
          const std::function<void()>& found) {
  Tuner tuner(runtime, encoders, tuning, found);
  for (const auto& encoder : encoders) tuner.tune_encoder(encoder);
}

void leave_to_rules(Tuning& tuning, const std::vector<TactileEncoderShape>& encoders) {
  for (const auto& encoder : encoders) {
    auto part = *known_part(tuning, encoder);
    for (const int images : {usual_part(encoder), part.images})
      for (const auto& shape : encoder.of_windows(images).layers()) {
        auto layer = *tuning.layer(shape);
        layer.choice = TactileEncoder::usual_choice(shape);
        layer.times.chosen_ms = layer.times.usual_ms;
        tuning.set(layer);
      }
    part.images = usual_part(encoder);
    part.times.chosen_ms = part.times.usual_ms;
    tuning.set(part);
  }
}

bool is_worth_having(const TunedTimes& updates) {
  return updates.chosen_ms < worth_it * updates.usual_ms;
}

TunedTimes update_times(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                        const Tuning& tuning) {
  NoiseTraining by_rules(runtime, spec, sequences, steps),
      by_choices(runtime, spec, sequences, steps, tuning);
  std::vector<double> usual, chosen;
  for (const auto& turn :
       interleaved_seconds(runtime, {[&] { by_rules.update(); }, [&] { by_choices.update(); }}))
    usual.push_back(1e3 * turn[0]), chosen.push_back(1e3 * turn[1]);
  return {median(usual), median(chosen)};
}

}  // namespace touchtrace
