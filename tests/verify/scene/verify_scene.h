#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace::scene {

/// Rows of `touchtrace-verify scene`: physics against closed forms, the statistics of clips, speed.
Verification verify_scene();

/// How much faster than life physics and glove are with a clip on every core.
void verify_speed(const std::string& activity, const std::function<void(Figure)>& emit);

/// Rows about the speed of the renderer on an activity's scene.
void verify_rendering(const std::string& activity, const std::function<void(Figure)>& emit);

/// Rows about clips of an activity with every object that it is done with: drops, grip, tosses.
void verify_objects(const std::string& activity, const std::function<void(Figure)>& emit);

/// Rows about how an umbrella is balanced.
void verify_balance(const std::function<void(Figure)>& emit);

/// Rows about the inertial unit: at rest, and its angular velocity integrated.
void verify_inertial(const std::function<void(Figure)>& emit);

/// Whether one frame of touch tells where the hand is, which it must not.
void verify_probe(const std::string& activity, const std::function<void(Figure)>& emit);

}  // namespace touchtrace::scene
