#pragma once

#include <nlohmann/json.hpp>

#include "pipeline/study/comparison.h"

namespace touchtrace::study {

/// Appends rows of the comparison, one per object and candidate, to `results`, `runs`, `curves` and
/// `differences` of a metrics document; with several objects also rows of object "all". split:
/// "seen" if all models were trained on the object, "unseen" if none was, else "mixed". `seed`: of
/// the bootstrap.
void append_results(nlohmann::json& document, const Comparison& comparison, std::uint64_t seed);

/// Appends the roll-outs at the median and the 10th and 90th percentile of the full model's L1@50
/// to `examples`: states in metres and m/s, scaled bands, tactile frames.
void append_examples(nlohmann::json& document, const Comparison& comparison);

}  // namespace touchtrace::study
