#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace::scene {

// Groups of rows of `touchtrace-verify scene`.

/// Speed of physics and glove relative to real time, with one clip per core.
void verify_speed(const std::string& activity, const std::function<void(Figure)>& emit);

/// Speed of the renderer for an activity's scene.
void verify_rendering(const std::string& activity, const std::function<void(Figure)>& emit);

/// Drops, grip forces and tosses of an activity with every object that it accepts.
void verify_objects(const std::string& activity, const std::function<void(Figure)>& emit);

/// Statistics of balancing an umbrella.
void verify_balance(const std::function<void(Figure)>& emit);

/// Inertial unit: at rest, and its integrated angular velocity.
void verify_inertial(const std::function<void(Figure)>& emit);

/// Error over run time: position of the object after 1 s of a stiff grip, an impact and a catch,
/// against a step 100 times smaller than the default.
void verify_precision(const std::function<void(Figure)>& emit);

/// Energy, forces and speeds over a grid of masses, stiffnesses, friction coefficients and steps.
void verify_extremes(const std::function<void(Figure)>& emit);

/// Whether one tactile frame tells the hand's position, which would be an artefact.
void verify_probe(const std::string& activity, const std::function<void(Figure)>& emit);

}  // namespace touchtrace::scene
