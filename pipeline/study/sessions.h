#pragma once

#include <string>
#include <vector>

#include "pipeline/dataset/load.h"
#include "pipeline/study/comparison.h"

namespace touchtrace::study {

/// Pairs recordings and label files by position; `labels` empty: labels_path_of() each recording. A
/// folder stands for the recordings in it, sorted by name. Throws usage_error if the numbers differ
/// or a folder has no recording.
std::vector<LabelledRecording> pair_files(const std::vector<std::string>& recordings,
                                          const std::vector<std::string>& labels);

/// Loads recordings for evaluation, at their glove's resolution. The truth, if any, is shifted onto
/// the labels (truth.h); `against` "labels" skips it.
std::vector<Session> load_sessions(const std::vector<LabelledRecording>& sources,
                                   const std::string& against);

}  // namespace touchtrace::study
