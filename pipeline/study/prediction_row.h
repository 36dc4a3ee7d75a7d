#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "pipeline/study/model_card.h"

namespace touchtrace::study {

/// Predicted state of hand and object as JSON:
///   {"step", "start", "object", "hand"}
/// "step" counts from the start of the roll-out, 1 is the first one. "start" is the origin of the
/// first state, "label" or "prior". Bodies have position_m and velocity_m_per_s, each with the
/// limits of its band, _low and _high.
///
/// `state`, `spread`: [state_size] from a predictor, scaled. The band is that of the model card; if
/// the roll-out started from the prior, the mean training state, the band contains its spread.
nlohmann::json prediction_row(const ModelCard& card, bool from_label, int step,
                              std::span<const float> state, std::span<const float> spread);

}  // namespace touchtrace::study
