#include "pipeline/scene/verify_scene.h"

#include <fmt/core.h>

#include "pipeline/scene/laboratory.h"
#include "pipeline/scene/scene.h"

namespace touchtrace::scene {
namespace {

using Emit = std::function<void(Figure)>;

void verify_physics(const Emit& emit) {
  emit(at_most("free flight: position error after 1 s", free_flight_error_m(0.002), "m", 1e-9));
  for (double mass_kg : {0.005, 0.17, 1.0})
    emit(within(fmt::format("block of {} kg at rest: force / weight", mass_kg),
                resting_force_ratio(mass_kg, 0.001, 3.0), "", 0.999, 1.001));
}

}  // namespace

Verification verify_scene() {
  return [](const Emit& emit) {
    for (const std::string& activity : activity_names()) verify_rendering(activity, emit);
    verify_physics(emit);
    for (const std::string& activity : activity_names()) {
      verify_probe(activity, emit);
      verify_objects(activity, emit);
    }
  };
}

}  // namespace touchtrace::scene
