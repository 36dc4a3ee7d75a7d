#pragma once

#include <nlohmann/json.hpp>

#include "pipeline/study/comparison.h"

namespace touchtrace::study {

/// Appends rows of the comparison, one per object and candidate, to `results`, `runs`, `curves` and
/// `differences` of a metrics document; with several objects also rows of object "all". split:
/// "seen" if all models were trained on the object, "unseen" if none was, else "mixed". `seed`: of
/// the bootstrap.
void append_results(nlohmann::json& document, const Comparison& comparison, std::uint64_t seed);

/// Appends the roll-outs with the median, smallest and largest L1@50 of the full model to
/// `examples`: states in metres and m/s, scaled bands, tactile frames, and where they start: clip
/// of a recording, seconds after the clip's start.
void append_examples(nlohmann::json& document, const Comparison& comparison);

}  // namespace touchtrace::study
