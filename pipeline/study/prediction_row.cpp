#include "pipeline/study/prediction_row.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/base/statistics.h"
#include "pipeline/study/metrics.h"

namespace touchtrace::study {
namespace {

using nlohmann::json;

struct Body {
  const char* name;
  Dimensions position, velocity;
};
constexpr Body bodies[] = {{"object", object_position, object_velocity},
                           {"hand", hand_position, hand_velocity}};

json values(const State& state, Dimensions dimensions) {
  return std::vector<float>(&state[dimensions.first], &state[dimensions.first] + dimensions.count);
}

void add_state(json& body, const char* name, const State& centre, const State& spread,
               Dimensions dimensions) {
  State low = centre, high = centre;
  for (int d = 0; d < state_size; ++d) low[d] -= spread[d], high[d] += spread[d];
  body[name] = values(centre, dimensions);
  body[std::string(name) + "_low"] = values(low, dimensions);
  body[std::string(name) + "_high"] = values(high, dimensions);
}

}  // namespace

json prediction_row(const ModelCard& card, bool from_label, int step, std::span<const float> state,
                    std::span<const float> spread) {
  // Half the width of the band of a standard normal distribution.
  const double prior_spread = from_label ? 0.0 : -normal_quantile(card.spec.band_quantile);
  State centre{}, half_band{};
  std::ranges::copy(state, centre.begin());
  for (int d = 0; d < state_size; ++d)
    half_band[d] = static_cast<float>(
        std::hypot(scaled_spread(card.band_scale, step - 1, spread[d]), prior_spread) *
        card.scaling.sigma[d]);
  centre = card.scaling.denormalize(centre);
  json row{{"step", step}, {"start", from_label ? "label" : "prior"}};
  for (const Body& body : bodies) {
    add_state(row[body.name], "position_m", centre, half_band, body.position);
    add_state(row[body.name], "velocity_m_per_s", centre, half_band, body.velocity);
  }
  return row;
}

}  // namespace touchtrace::study
