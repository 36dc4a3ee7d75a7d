#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/options.h"
#include "engine/base/provenance.h"
#include "engine/cl/runtime.h"

namespace touchtrace::study {

/// Options of `touchtrace sensitivity`.
struct SensitivityOptions {
  std::string output, activity = "wave";
  std::vector<std::string> only;  ///< parameter names or prefixes; empty: all
  int seeds = 3;                  ///< of the default; each other cell has the first
  int clips = 60, updates = 800, resolution = 16, window = 4;
  bool images = false;  ///< labels of rendered images; otherwise modelled ones
  bool resume = false;
};

void describe(OptionSet& set, SensitivityOptions& options);

/// Measures the effect of the scene's parameters on the models. For each parameter, halved and
/// doubled within its range: simulates clips of the activity's default object, labels them with
/// modelled errors or, with `images`, from rendered images (simulated_labels.h), trains with and
/// without touch, and evaluates on held-out clips relative to the truth. All cells of a seed share
/// their random numbers; a model whose data did not change is not trained again. The document,
/// saved in `options.output` after each cell, has
///   cells   rows {assumption, factor, seed, value, dropped_clips, full, without_touch, random}:
///           L1@50 in units of the cell's own label sigmas; null if too many clips were dropped
/// Throws usage_error for an unknown parameter.
nlohmann::json measure_sensitivity(Runtime& runtime, const SensitivityOptions& options,
                                   Provenance provenance, bool overwrite);

/// Markdown table with one row per parameter: L1@50 at half, default and double; mean and standard
/// deviation over the default's seeds; below, the parameters that did not change the data.
std::string sensitivity_table(const nlohmann::json& document);

}  // namespace touchtrace::study
