#pragma once

#include <string>
#include <vector>

#include "pipeline/dataset/load.h"
#include "pipeline/study/contest.h"

namespace touchtrace::study {

/// The i-th recording with the i-th labels. Throws usage_error if there are not as many of each.
std::vector<LabelledRecording> paired(const std::vector<std::string>& recordings,
                                      const std::vector<std::string>& labels);

/// Each recording for evaluation, its tactile frames as `models` of its activity take them; with
/// truth, shifted onto the labels, where the recording has one. `against` "labels" leaves the truth
/// unread.
std::vector<Session> load_sessions(const std::vector<LabelledRecording>& sources,
                                   const std::vector<LoadedModel>& models,
                                   const std::string& against);

}  // namespace touchtrace::study
