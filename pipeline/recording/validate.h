#pragma once

#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// What the shapes of the arrays cannot say: finite and strictly increasing times, sensible
/// attributes, clips in order. Each throws data_error; `name` starts the message.
void validate(const Recording& recording, const std::string& name);
void validate(const Truth& truth, const std::string& name);
void validate(const Labels& labels, const std::string& name);

}  // namespace touchtrace
