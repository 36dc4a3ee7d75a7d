#pragma once

#include "engine/base/options.h"
#include "engine/cl/runtime.h"
#include "pipeline/cli/record_devices.h"

namespace touchtrace::cli {

/// Options of `predict` for a glove.
struct LiveOptions {
  DeviceOptions devices;
  double rest_s = 2.0;
  bool page = false;
  int port = 0;
};

void describe(OptionSet& set, LiveOptions& options);

/// Predicts from each frame of the glove as it arrives and prints one JSON line for each, until the
/// glove's file ends or Ctrl-C: rows of live_prediction.h with "latency_s", the time from the
/// frame's last byte to the line (null for a file that is not replayed at the glove's pace). While
/// the baseline is learnt, "start" is "rest".
void predict_live(Runtime& runtime, const std::string& model, const LiveOptions& options);

}  // namespace touchtrace::cli
