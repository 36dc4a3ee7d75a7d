#pragma once

#include "pipeline/scene/base/scene.h"
#include "tests/verify/scene/closed_forms.h"

namespace touchtrace::scene {

/// What a ball does in the air and in an impact, and a formula tells, too.
const std::vector<ClosedForm>& ball_forms();

/// A square plate of 20 x 20 x 2 cm, for tests, with a ball of table tennis.
ObjectSpec plate(double mass_kg);

}  // namespace touchtrace::scene
