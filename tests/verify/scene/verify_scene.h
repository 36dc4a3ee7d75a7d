#pragma once

#include <filesystem>

#include "tests/verify/support/figure.h"

namespace touchtrace::scene {

/// Rows of `touchtrace-verify scene`: closed forms, error over run time, statistics of clips,
/// speed.
Verification verify_scene();

/// Rows of `touchtrace-verify scene --real FOLDER`: statistics of the gloves in a folder of
/// recordings, and those of simulated gloves, which should be within the range of the recorded
/// ones.
Verification verify_gloves(const std::filesystem::path& folder);

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

/// Whether one tactile frame tells the hand's position, which would be an artefact.
void verify_probe(const std::string& activity, const std::function<void(Figure)>& emit);

}  // namespace touchtrace::scene
