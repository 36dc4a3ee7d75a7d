#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "calib/smooth/smooth.h"
#include "engine/base/provenance.h"
#include "pipeline/cli/smooth_inputs.h"

namespace touchtrace::cli {

/// Content of smooth.json. `inputs` and `smoothed.tracks` correspond.
nlohmann::json smooth_summary(const std::vector<SmoothInput>& inputs,
                              const SmoothedTracks& smoothed, const Provenance& provenance);

/// Prints a table of the tracks in a summary, and their noise.
void print_smooth_summary(const nlohmann::json& summary);

}  // namespace touchtrace::cli
