#pragma once

#include <functional>
#include <vector>

#include "engine/model/model_spec.h"
#include "engine/model/tactile_encoder.h"

namespace touchtrace {

/// The encoders of a training update of S sequences and T steps: that of the windows of touch and
/// that of the objects' segments, of which a batch of contrastive training holds
/// `object_segments`. Empty without touch.
std::vector<TactileEncoderShape> encoders_in_training(const ModelSpec& spec, int sequences,
                                                      int steps, int object_segments);

/// Whether nothing is left to tune for these encoders.
bool is_complete(const Tuning& tuning, const std::vector<TactileEncoderShape>& encoders);

/// Measures what `tuning` lacks for these encoders: each layer's choice, the number of windows in a
/// part, and the layers' choices for such a part. Of ways that differ by less than the measurement
/// tells, the usual one stays. `found` is called after each shape, so that it can be kept; Ctrl-C
/// throws in between.
void tune(Runtime& runtime, const std::vector<TactileEncoderShape>& encoders, Tuning& tuning,
          const std::function<void()>& found);

/// Takes complete choices for these encoders back: all go by the usual rules, as tuned.
void leave_to_rules(Tuning& tuning, const std::vector<TactileEncoderShape>& encoders);

/// Whether choices make whole updates so much faster that they are worth having: what is faster
/// alone may not be beside the other layers.
bool is_worth_having(const TunedTimes& updates);

/// Milliseconds of whole updates, in turns: without and with the choices.
TunedTimes update_times(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                        const Tuning& tuning);

}  // namespace touchtrace
