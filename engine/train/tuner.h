#pragma once

#include <functional>
#include <vector>

#include "engine/model/conv_stack_shape.h"
#include "engine/model/model_spec.h"
#include "engine/ops/tuning.h"

namespace touchtrace {

/// Encoders of a training update of S sequences and T steps: that of the windows, and that of the
/// segments, of which a contrastive batch (ObjectEncoder::frozen) has `object_segments`. Empty
/// without touch.
std::vector<ConvStackShape> training_encoders(const ModelSpec& spec, int sequences, int steps,
                                              int object_segments);

/// Whether these encoders are tuned completely.
bool is_complete(const Tuning& tuning, const std::vector<ConvStackShape>& encoders);

/// Adds to `tuning` what it lacks for these encoders: the configuration of each layer, the size of
/// a micro-batch, and the layers' configurations for that size. The default configuration is kept
/// unless another is measurably faster. Calls `on_result` after each shape, so that it can be
/// saved; Ctrl-C throws in between.
void tune(Runtime& runtime, const std::vector<ConvStackShape>& encoders, Tuning& tuning,
          const std::function<void()>& on_result);

/// Sets the default configurations for these encoders, marked as tuned.
void reset_to_defaults(Tuning& tuning, const std::vector<ConvStackShape>& encoders);

/// Whether the tuning makes whole updates faster: a layer that is faster alone need not be faster
/// between the others.
bool is_faster(const TunedTimes& updates);

/// Measures whole updates without and with `tuning`, interleaved.
TunedTimes measure_update_times(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                                const Tuning& tuning);

}  // namespace touchtrace
