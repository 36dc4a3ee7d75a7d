#include "pipeline/study/live_prediction.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/error.h"
#include "pipeline/study/prediction_row.h"
#include "pipeline/study/rollouts.h"

namespace touchtrace::study {
namespace {

using nlohmann::json;

constexpr double min_rate_span_s = 10.0, max_rate_error = 0.05;
constexpr double max_pause_s = 1.0;  // of the host, in which frames pile up

/// Average to the model's images; without touch it is not used.
AreaAverage average_of(const GloveInfo& glove, const ModelSpec& spec) {
  return spec.touch ? AreaAverage(glove.rows, glove.cols, spec.rows, spec.cols)
                    : AreaAverage(glove.rows, glove.cols, 1, 1);
}

/// Row of a frame that completes no window.
json waiting_row() {
  return {{"step", 0}, {"start", "window"}, {"object", nullptr}, {"hand", nullptr}};
}

}  // namespace

GloveInfo with_all_taxels(GloveInfo glove) {
  glove.mask.assign(static_cast<std::size_t>(glove.taxels()), 1);
  glove.baseline_counts.resize(static_cast<std::size_t>(glove.taxels()), 0.0f);
  return glove;
}

json touch_summary(std::span<const float> pressure) {
  const float sum = std::accumulate(pressure.begin(), pressure.end(), 0.0f);
  return {{"mean", sum / static_cast<float>(pressure.size())},
          {"max", std::ranges::max(pressure)},
          {"contact_taxels",
           std::ranges::count_if(pressure, [](float taxel) { return taxel >= contact_pressure; })}};
}

LivePrediction::LivePrediction(Runtime& runtime, const std::string& model, const GloveInfo& glove,
                               const std::string& port)
    : online_(runtime, model),
      card_(read_card(online_.metadata(), model)),
      glove_(with_all_taxels(glove)),
      model_(model),
      port_(port),
      average_(average_of(glove, card_.spec)),
      pressure_(static_cast<std::size_t>(glove.taxels())),
      image_(static_cast<std::size_t>(card_.spec.rows) * card_.spec.cols) {
  require_rate(card_, model, glove.rate_hz, port);
  warm_up();
}

void LivePrediction::set_baseline(std::vector<float> counts) {
  glove_.baseline_counts = std::move(counts);
}

/// Steps with a frame of zeros, so that all kernels are compiled before the first frame. The window
/// stays zero.
void LivePrediction::warm_up() {
  const bool has_object = card_.spec.object != ObjectEncoder::none;
  online_.set_state(std::vector<float>(state_size));
  online_.set_object(std::vector<float>(
      has_object ? image_.size() * static_cast<std::size_t>(card_.spec.segment_frames) : 0));
  online_.step(image());
}

void LivePrediction::reset() {
  if (first_) ++clip_;
  first_.reset(), last_.reset();
  segment_.clear();
  frames_ = step_ = 0;
  embedding_ = "none";
}

void LivePrediction::add(std::uint64_t sequence, double time_s,
                         std::span<const std::uint16_t> counts, const Emit& emit) {
  if (last_ && sequence - last_->sequence - 1 > max_bridged_frames) reset();
  if (last_)
    for (auto lost = last_->sequence + 1; lost < sequence; ++lost, ++bridged_frames_)
      advance({lost, time_s - static_cast<double>(sequence - lost) / card_.rate_hz, false}, emit);
  counts_to_pressure(glove_, counts, pressure_);
  average_.apply(pressure_, image_);
  const Frame frame{sequence, time_s, true};
  advance(frame, emit);
  require_rate_of(frame);
}

void LivePrediction::require_rate_of(const Frame& frame) const {
  const double span_s = frame.time_s - first_->time_s;
  const auto frames = static_cast<double>(frame.sequence - first_->sequence);
  const double error_s = std::abs(frames / card_.rate_hz - span_s);
  if (span_s >= min_rate_span_s && !(error_s <= max_pause_s + max_rate_error * span_s))
    throw data_error(fmt::format("{} was trained at {:g} Hz, {} sends {:.2f} frames per second",
                                 model_, card_.rate_hz, port_, frames / span_s),
                     "use a glove of the same rate; frames are not resampled");
}

void LivePrediction::advance(const Frame& frame, const Emit& emit) {
  if (!first_) first_ = frame;
  last_ = frame;
  ++frames_;
  if (card_.spec.object != ObjectEncoder::none && frames_ <= card_.spec.segment_frames)
    segment_.insert(segment_.end(), image_.begin(), image_.end());
  start_rollout();
  json row;
  if (step_ == 0) {
    online_.push(image());
    row = waiting_row();
  } else {
    const auto [state, spread] = online_.step(image());
    row = prediction_row(card_, false, step_++, state, spread);
  }
  row.update({{"clip", clip_},
              {"sequence", frame.sequence},
              {"time_s", frame.time_s + 1.0 / card_.rate_hz},
              {"received", frame.is_received},
              {"embedding", embedding_},
              {"touch", frame.is_received ? touch_summary(pressure_) : json()}});
  emit(std::move(row));
}

/// Starts a roll-out from the prior if this frame completes the window or the object segment.
void LivePrediction::start_rollout() {
  const bool has_object = card_.spec.object != ObjectEncoder::none;
  if (frames_ == required_history(card_.spec)) {
    if (has_object) online_.set_object(segment_), embedding_ = "segment";
  } else if (has_object && frames_ == card_.spec.window_frames && !card_.mean_embedding.empty()) {
    online_.set_object_embedding(card_.mean_embedding), embedding_ = "mean";
  } else {
    return;
  }
  online_.set_state(std::vector<float>(state_size));
  step_ = 1;
}

std::span<const float> LivePrediction::image() const {
  return card_.spec.touch ? std::span<const float>(image_) : std::span<const float>();
}

}  // namespace touchtrace::study
