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
  std::vector<std::string> only;  ///< names of assumptions, or how they begin; empty: all
  int seeds = 3;                  ///< of the default; each other cell has the first
  int clips = 60, updates = 800, resolution = 16, window = 4;
  bool images = false;  ///< labels of rendered images; otherwise modelled ones
  bool resume = false;
};

void describe(OptionSet& set, SensitivityOptions& options);

/// What the scene's assumptions do to what is learnt. For each assumption, halved and doubled (as
/// far as its range goes): simulates clips of the activity's default object, gives them labels that
/// err as the vision pipeline's do or, with `images`, renders what that labels
/// (simulated_labels.h), trains with and without touch, and rolls out on held-out clips against the
/// truth. All cells of a seed share their random numbers; what a change does not reach is not
/// trained again. The document, kept in `options.output` from cell to cell, has
///   cells   rows {assumption, factor, seed, value, dropped_clips, full, without_touch, random}:
///           L1@50 in units of the cell's own deviations; null where too few clips held the object
/// Throws usage_error for an assumption that there is not.
nlohmann::json measure_sensitivity(Runtime& runtime, const SensitivityOptions& options,
                                   Provenance provenance, bool overwrite);

/// A Markdown table: an assumption a row, L1@50 at half, default and double, and what the default's
/// seeds spread. Below it the assumptions that changed nothing in the data.
std::string sensitivity_table(const nlohmann::json& document);

}  // namespace touchtrace::study
