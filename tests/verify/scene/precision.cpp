#include <fmt/core.h>

#include <array>
#include <cmath>
#include <numbers>

#include "tests/verify/scene/setups.h"
#include "tests/verify/scene/verify_scene.h"
#include "tests/verify/support/thread_clock.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

constexpr double interval_s = 0.002, default_step_s = 0.002;
constexpr std::array<double, 6> steps_s{0.002, 0.001, 0.0005, 0.00025, 0.000125, 0.0000625};

struct Setting {
  std::string name;
  ThetaRange theta;
};

const std::vector<Setting>& settings() {
  static const std::vector<Setting> table{
      {"midpoint, Euler where stiff", {}},
      {"implicit midpoint", {0.5, 0.5}},
      {"implicit Euler", {1.0, 1.0}},
  };
  return table;
}

/// One second of simulation: `place` sets the start, `drive` the command of each interval.
struct Scenario {
  std::string name;
  double max_error_mm;  ///< required at the default step
  ObjectSpec object;
  std::function<void(World&)> place;
  std::function<Drive(const World&, double time_s)> drive;
};

Drive with_fingers(const World& world, const FingerDrive& each) {
  Drive drive = hold_still(world);
  drive.position_m.setZero();
  drive.carried_weight_n = world.spec().mass_kg * gravity_m_per_s2;
  drive.fingers.fill(each);
  return drive;
}

/// Fingers and thumb press with about 60 N in total while the arm oscillates at 2 Hz.
Drive gripping(const World& world, double time_s) {
  const double rate = 4.0 * std::numbers::pi, way_m = 0.05;
  Drive drive = with_fingers(world, {0.6, 1.0, 0.9});
  drive.position_m.x() = way_m * (1.0 - std::cos(rate * time_s));
  drive.velocity_m_per_s.x() = way_m * rate * std::sin(rate * time_s);
  drive.acceleration_m_per_s2.x() = way_m * rate * rate * std::cos(rate * time_s);
  return drive;
}

const std::vector<Scenario>& scenarios() {
  static const std::vector<Scenario> table{
      {"stiff grip", 0.1, block(0.3, 0.7, {0.02, 0.045, 0.02}),
       [](World& world) {
         world.flexion_rad.fill(0.6);
         place_above(world, {0.015, 0.0, 0.0}, 0.0);
       },
       gripping},
      {"impact", 1.0, sphere(0.05, 0.7, 0.0286),
       [](World& world) {
         place_above(world, {0.01, 0.004, 0.0}, 0.01);
         world.object.velocity_m_per_s = {0.1, 0.0, -3.0};
       },
       [](const World& world, double) {
         return with_fingers(world, {0.0, 3.0, 0.0});
       }},
      {"catch", 0.5, sphere(0.17, 0.7, 0.0286),
       [](World& world) {
         place_above(world, {0.01, 0.004, 0.0}, 0.05);
         world.object.velocity_m_per_s = {0.1, 0.0, -1.5};
       },
       [](const World& world, double) {
         return with_fingers(world, {0.0, 3.0, 0.6});
       }},
  };
  return table;
}

struct Outcome {
  Vector3d position_m;
  double seconds;
};

Outcome perform_scenario(const Scenario& scenario, const ThetaRange& theta, double step_s) {
  World world(scenario.object, {}, {}, theta);
  scenario.place(world);
  const double start = thread_cpu_seconds();
  for (double t = 0.0; t < 1.0 - 0.5 * interval_s; t += interval_s)
    world.advance(scenario.drive(world, t), interval_s, step_s);
  return {world.object.position_m, thread_cpu_seconds() - start};
}

Picture::Curve work_precision(const Scenario& scenario, const Setting& setting,
                              const Vector3d& reference_m) {
  Picture::Curve curve{setting.name, {}, {}};
  for (double step_s : steps_s) {
    const Outcome outcome = perform_scenario(scenario, setting.theta, step_s);
    curve.x.push_back(outcome.seconds);
    curve.y.push_back(1e3 * (outcome.position_m - reference_m).norm());
  }
  return curve;
}

/// Run time of `other` for the error of `ours` at the default step, relative to ours; of its last
/// point if it never reaches that error.
double relative_time(const Picture::Curve& ours, const Picture::Curve& other) {
  for (std::size_t i = 0; i < other.y.size(); ++i)
    if (other.y[i] <= ours.y.front()) return other.x[i] / ours.x.front();
  return other.x.back() / ours.x.front();
}

}  // namespace

void verify_precision(const std::function<void(Figure)>& emit) {
  for (const Scenario& scenario : scenarios()) {
    const Vector3d reference_m = perform_scenario(scenario, {}, default_step_s / 100).position_m;
    Picture picture{"seconds for 1 s", "error / mm", true, true, {}};
    for (const Setting& setting : settings())
      picture.curves.push_back(work_precision(scenario, setting, reference_m));
    const auto &ours = picture.curves.front(), &euler = picture.curves.back();
    emit(reported(scenario.name + ": implicit Euler's time for the same error",
                  relative_time(ours, euler), "x"));
    Figure error =
        at_most(fmt::format("{}: error after 1 s, {:g} ms", scenario.name, 1e3 * default_step_s),
                ours.y.front(), "mm", scenario.max_error_mm);
    error.picture = std::move(picture);
    emit(std::move(error));
  }
}

}  // namespace touchtrace::scene
