#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/ops/tuning.h"

namespace touchtrace {

/// {"layers": [{"images", "in_channels", ..., "method", ..., "default_ms", "tuned_ms"}],
/// "micro_batches": [...]}. Numbers left to the default configuration are omitted.
void to_json(nlohmann::json& json, const Tuning& tuning);
/// Also reads the key names of older versions. Throws nlohmann::json::exception or data_error for
/// anything that to_json does not write.
void from_json(const nlohmann::json& json, Tuning& tuning);

/// E.g. "winograd, group images 4".
std::string describe(const Conv2dChoice& choice);

}  // namespace touchtrace
