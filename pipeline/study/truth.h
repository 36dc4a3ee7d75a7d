#pragma once

#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// Constant offset between labels, which follow the centres of the visible hand and object, and
/// truth, which is palm centre and centre of mass: mean of label - truth positions over the trusted
/// frames of the training clips. Zero without such frames; velocities are 0.
State estimate_truth_offset(const Dataset& data);

/// Adds an offset to the truth and to Dataset::truth_offset.
void shift_truth(Dataset& data, const State& offset);

}  // namespace touchtrace::study
