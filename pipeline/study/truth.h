#pragma once

#include <array>

#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// Constant offset between labels, which follow the centres of the visible hand and object, and
/// truth, which is palm centre and centre of mass: mean of label - truth over the trusted frames of
/// the training clips.
struct TruthOffset {
  std::array<double, 3> object_m{}, hand_m{};
};

/// Zero without trusted training frames.
TruthOffset estimate_offset(const Dataset& data);
/// Adds the offset to the truth's positions; velocities stay.
void shift_truth(Dataset& data, const TruthOffset& offset);

}  // namespace touchtrace::study
