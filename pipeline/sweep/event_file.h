#pragma once

#include <string>
#include <vector>

#include "pipeline/sweep/manifest.h"

namespace touchtrace::sweep {

/// Content of a TensorBoard event file with a scalar curve for every numeric member of the training
/// log in a result: the array whose entries have an "update". Empty if there is none.
std::string event_file_of(const nlohmann::ordered_json& result);

}  // namespace touchtrace::sweep
