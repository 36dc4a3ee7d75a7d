#pragma once

#include "pipeline/scene/base/scene.h"
#include "tests/verify/scene/closed_forms.h"

namespace touchtrace::scene {

/// Closed forms of flight and impacts of a ball.
const std::vector<ClosedForm>& ball_closed_forms();

/// Kinetic energy of the object and its ball.
double kinetic_energy_j(const ObjectSpec& object, const RigidState& held, const RigidState& ball);

/// Square plate of 20 x 20 x 2 cm with a table tennis ball.
ObjectSpec plate(double mass_kg);

}  // namespace touchtrace::scene
