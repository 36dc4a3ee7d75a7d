#pragma once

#include <nlohmann/json.hpp>

#include "pipeline/study/contest.h"

namespace touchtrace::study {

/// Appends, object by object, the contest's rows to `results`, `curves` and `differences` of a
/// document. split is "seen" for objects that the models were trained on, "unseen" otherwise.
void append_results(nlohmann::json& document, const Contest& contest, std::uint64_t seed);

/// Appends to `examples` the roll-outs whose L1@50 by the full model is the median, the 10th and
/// the 90th percentile: states in metres and m/s, bands after scaling, and the tactile frames
/// behind them.
void append_examples(nlohmann::json& document, const Contest& contest);

}  // namespace touchtrace::study
