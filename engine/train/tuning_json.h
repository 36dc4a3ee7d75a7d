#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/ops/tuning.h"

namespace touchtrace {

/// {"layers": [{"images", "in_channels", ..., "method", ..., "usual_ms", "chosen_ms"}], "parts":
/// [...]}; a number that is left to the usual rule is left out.
void to_json(nlohmann::json& json, const Tuning& tuning);
/// Throws nlohmann::json::exception or data_error for anything that to_json does not write.
void from_json(const nlohmann::json& json, Tuning& tuning);

/// "winograd, group images 4"
std::string describe(const Conv2dChoice& choice);

}  // namespace touchtrace
