#pragma once

#include <filesystem>

#include "pipeline/label/label.h"
#include "pipeline/scene/simulate/simulate.h"

namespace touchtrace::cli {

/// Simulates a recording, calibrates its camera and labels it from images that are rendered when
/// they are read and never stored. Writes X.h5 without images, X.calibration and, last,
/// X.labels.h5; the labels are those of `simulate`, `calibrate` and `label`. Throws data_error if
/// calibration or labelling fail.
scene::SimulationSummary simulate_labelled(const scene::SceneOptions& options, Runtime& runtime,
                                           const label::LabelOptions& labelling,
                                           const std::filesystem::path& recording, bool overwrite,
                                           const Provenance& provenance);

}  // namespace touchtrace::cli
