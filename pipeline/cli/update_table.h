#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "engine/train/update_plan.h"

namespace touchtrace::cli {

/// One row a kernel, in the order in which they are first queued.
void print_update(const std::vector<PlannedLaunch>& launches);
/// {"launches":[{"kernel","purpose","flops","bytes","tuned"}...]}
nlohmann::json update_json(const std::vector<PlannedLaunch>& launches);

/// One row for launches of the same kernel, purpose and cost, one a purpose, and the whole update.
/// Columns: of launches alone and again and again the time each, the sum, its share of all
/// launches, the share of the peak, and bytes a second; the sum in place, in ms.
void print_update(const MeasuredUpdate& update);
/// {"launches":[as above, and "seconds","seconds_in_place","share","share_of_peak",
/// "bytes_per_second"...], "purposes":[{"purpose","launches","flops","bytes", and these}...],
/// "update":{"launch_seconds","launch_seconds_in_place","cpu_seconds","wall_seconds","peak_flops"}}.
nlohmann::json update_json(const MeasuredUpdate& update);

}  // namespace touchtrace::cli
