#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/base/options.h"
#include "engine/cl/runtime.h"

namespace touchtrace::study {

/// Options of `touchtrace predict`.
struct PredictionOptions {
  std::string model, recording, labels, output;  ///< labels: empty for none
  int restart_steps = 0;                         ///< 0: one roll-out per clip
  std::string accuracy = "fast";
};

void describe(OptionSet& set, PredictionOptions& options);

/// Rolls the model out over every clip and calls `emit` with each predicted frame: a row of
/// prediction_row.h with "clip" and "time_s".
///
/// A roll-out starts as soon as the model's window (and object segment) is full, from the filtered
/// label where it is trusted, else from the mean of the training labels, whose spread then is part
/// of the band. With `restart_steps` it starts again after so many steps at the next trusted label.
/// Throws data_error if model and glove do not match or no clip is long enough.
void predict(Runtime& runtime, const PredictionOptions& options,
             const std::function<void(const nlohmann::json&)>& emit);

}  // namespace touchtrace::study
