#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "engine/train/update_plan.h"

namespace touchtrace::cli {

/// Prints one row per kernel, in the order of first use.
void print_update(const std::vector<PlannedLaunch>& launches);
/// {"launches":[{"kernel","purpose","flops","bytes"}...]}
nlohmann::json update_json(const std::vector<PlannedLaunch>& launches);

/// Prints one row per kernel, purpose and cost, one per purpose, and the whole update. Columns:
/// time per launch and sum, measured by repeating each launch alone; share of all launches;
/// fraction of the peak FLOP/s; bandwidth; sum measured in place, within the update [ms].
void print_update(const MeasuredUpdate& update);
/// {"launches":[as above, with "seconds","seconds_in_place","share","share_of_peak",
/// "bytes_per_second"...], "purposes":[{"purpose","launches","flops","bytes", and these}...],
/// "update":{"launch_seconds","launch_seconds_in_place","cpu_seconds","wall_seconds","peak_flops"}}.
nlohmann::json update_json(const MeasuredUpdate& update);

}  // namespace touchtrace::cli
