#pragma once

#include <array>

#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// Labels follow the visible hand and object, truth their palm centre and centre of mass. The
/// constant part of that difference means nothing: it is estimated on the training clips (mean of
/// label - truth over trusted frames) and added to the truth's positions. Velocities stay as they
/// are.
struct TruthOffset {
  std::array<double, 3> object_m{}, hand_m{};
};

TruthOffset estimate_offset(const Dataset& data);
void shift_truth(Dataset& data, const TruthOffset& offset);

}  // namespace touchtrace::study
