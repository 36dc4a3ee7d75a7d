#pragma once

#include "pipeline/recording/file_faults.h"
#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Record faults of values: times that are not finite or run backward, counters that do not
/// increase strictly, attributes out of range, clips out of order. Types and shapes are checked by
/// h5::Loader. Paths of faults are those of the file. `color`, `depth`: paths of the camera's
/// groups.
void validate(const Recording& recording, const std::string& color, const std::string& depth,
              FileFaults& faults);
void validate(const CameraTimes& times, const std::string& group, FileFaults& faults);
void validate(const Truth& truth, FileFaults& faults);
void validate(const Labels& labels, FileFaults& faults);

}  // namespace touchtrace
