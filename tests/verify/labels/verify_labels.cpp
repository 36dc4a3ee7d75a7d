#include <fmt/core.h>

#include <array>
#include <cmath>

#include "pipeline/scene/person/activity.h"
#include "tests/verify/calib/smoothing_figures.h"
#include "tests/verify/labels/label_trials.h"
#include "tests/verify/labels/tracker_table.h"
#include "tests/verify/verifications.h"

namespace touchtrace::study {
namespace {

using Emit = std::function<void(Figure)>;

/// Seeds, and with them cameras and calibrations, differ between scenes. A calibration's error is
/// in all labels made with it, so many calibrations are more informative than three.
constexpr std::uint64_t first_seed = 1, seeds = 3;

struct Scene {
  const char *activity, *object;  ///< null: the activity's default
};
constexpr std::array<Scene, 12> scenes{{{"wave", nullptr},
                                        {"throw", nullptr},
                                        {"pingpong", nullptr},
                                        {"balance", nullptr},
                                        {"wave", "box"},
                                        {"wave", "egg"},
                                        {"wave", "can"},
                                        {"throw", "cube"},
                                        {"throw", "soap"},
                                        {"throw", "can"},
                                        {"wave", "foam"},
                                        {"wave", "pipe"}}};
constexpr std::array covered_activities{"wave", "throw", "pingpong"};
constexpr std::array gloved_activities{"wave", "throw"};
constexpr std::array occlusion_trackers{"csrt", "component"};

/// Goals of position RMS along x, y and depth. Lower for pingpong: the ball is never hidden.
std::array<double, 3> goals_mm(const std::string& activity) {
  if (activity == "pingpong") return {2.0, 2.0, 2.0};
  return {5.0, 5.0, 8.0};
}

/// One body's errors over several seeds.
class Errors {
 public:
  void add(const BodyError& error) { errors_.push_back(error); }
  void add(const Errors& others) {
    errors_.insert(errors_.end(), others.errors_.begin(), others.errors_.end());
  }

  double mean(double BodyError::*member) const {
    double sum = 0.0;
    for (const auto& error : errors_) sum += error.*member;
    return sum / static_cast<double>(errors_.size());
  }
  /// Standard error of the mean over recordings: labels of one recording share a calibration, a
  /// shape and much of their error.
  double standard_error(double BodyError::*member) const {
    const double mean_value = mean(member), count = static_cast<double>(errors_.size());
    const double spread =
        root_mean([&](const BodyError& e) { return std::pow(e.*member - mean_value, 2); });
    return spread / std::sqrt(count - 1.0);
  }
  double rms(double BodyError::*member) const {
    return root_mean([&](const BodyError& e) { return std::pow(e.*member, 2); });
  }
  double rms(Eigen::Vector3d BodyError::*member, int axis) const {
    return root_mean([&](const BodyError& e) { return std::pow((e.*member)[axis], 2); });
  }
  double rms(Eigen::Vector3d BodyError::*member) const {
    return root_mean([&](const BodyError& e) { return (e.*member).squaredNorm(); });
  }

 private:
  template <class Square>
  double root_mean(Square&& square) const {
    double sum = 0.0;
    for (const auto& error : errors_) sum += square(error);
    return std::sqrt(sum / static_cast<double>(errors_.size()));
  }

  std::vector<BodyError> errors_;
};

/// Consistency of covariances.
void emit_covariance(const std::string& name, const Errors& errors, const Emit& emit) {
  emit(within(name + ": object positions in their 80 % interval",
              errors.mean(&BodyError::position_coverage), "", 0.76, 0.84));
  emit(within(name + ": object velocities in their 80 % interval",
              errors.mean(&BodyError::velocity_coverage), "", 0.76, 0.84));
  emit(within(name + ": object NEES", errors.mean(&BodyError::nees), "", 0.8, 1.25));
}

void emit_standard_errors(const std::string& name, const Errors& errors, const Emit& emit) {
  emit(reported(name + ": object positions in their interval, standard error",
                errors.standard_error(&BodyError::position_coverage), ""));
  emit(reported(name + ": object velocities in their interval, standard error",
                errors.standard_error(&BodyError::velocity_coverage), ""));
  emit(reported(name + ": object NEES, standard error", errors.standard_error(&BodyError::nees),
                ""));
}

void emit_object(const std::string& name, const Errors& errors, const Errors& exact,
                 const Errors& white, const std::array<double, 3>& max_mm, const Emit& emit) {
  const auto percent = [&](double BodyError::*share) { return 100.0 * errors.mean(share); };
  emit(at_most(name + ": object lost or wrong",
               percent(&BodyError::lost_share) + percent(&BodyError::wrong_share), "%", 1.5));
  emit(at_most(name + ": object wrong without a flag", percent(&BodyError::wrong_unsaid_share), "%",
               0.5));
  emit(reported(name + ": object hidden, flagged as following the hand",
                percent(&BodyError::follows_share), "%"));
  emit(reported(name + ": object outside the image", percent(&BodyError::outside_share), "%"));
  const char* axes[] = {"x", "y", "depth"};
  for (int axis = 0; axis < 3; ++axis)
    emit(at_most(name + ": object position RMS about its bias, " + axes[axis],
                 1e3 * errors.rms(&BodyError::position_spread_m, axis), "mm",
                 max_mm[static_cast<std::size_t>(axis)]));
  emit(reported(name + ": object bias", 1e3 * errors.rms(&BodyError::bias_m), "mm"));
  emit(reported(name + ": labels next to an impact, excluded below",
                percent(&BodyError::impact_share), "%"));
  const double exact_m_per_s = exact.rms(&BodyError::aligned_velocity_rms_m_per_s);
  emit(reported(name + ": object velocity RMS of exact positions", exact_m_per_s, "m/s"));
  emit(reported(name + ": object velocity RMS of exact positions with the track's white errors",
                white.rms(&BodyError::aligned_velocity_rms_m_per_s), "m/s"));
  emit(at_most(name + ": object velocity RMS", errors.rms(&BodyError::aligned_velocity_rms_m_per_s),
               "m/s", 1.5 * exact_m_per_s));
  emit(reported(name + ": object velocity RMS, latency included",
                errors.rms(&BodyError::velocity_rms_m_per_s), "m/s"));
  emit(reported(name + ": object velocity RMS, filtered, latency included",
                errors.rms(&BodyError::causal_velocity_rms_m_per_s), "m/s"));
  emit(reported(name + ": delay", 1e3 * errors.mean(&BodyError::delay_s), "ms"));
  emit_covariance(name, errors, emit);
}

void emit_hand(const std::string& name, const Errors& errors, const Emit& emit) {
  emit(reported(name + ": offset of the hand's centroid from the palm",
                1e3 * errors.rms(&BodyError::bias_m), "mm"));
  emit(reported(name + ": hand position RMS about that offset",
                1e3 * errors.rms(&BodyError::position_spread_m), "mm"));
  emit(reported(name + ": hand velocity RMS", errors.rms(&BodyError::aligned_velocity_rms_m_per_s),
                "m/s"));
  emit(reported(name + ": hand velocity RMS, latency included",
                errors.rms(&BodyError::velocity_rms_m_per_s), "m/s"));
  emit(reported(name + ": hand velocity RMS, filtered, latency included",
                errors.rms(&BodyError::causal_velocity_rms_m_per_s), "m/s"));
}

/// Measures one activity and object over `seeds` seeds with tracker `component`; other trackers are
/// in tracker_table. Returns the object's errors.
Errors measure_scene(const std::string& activity, const std::string& object, std::uint64_t first,
                     const Emit& emit, Progress& progress) {
  Errors object_errors, hand_errors, exact, white;
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    const RenderedRecording rendered({activity, scene::find_object(object), seed});
    const auto labels = rendered.label("component");
    const auto error = compare_labels_with_truth(labels, rendered.truth());
    object_errors.add(error.object), hand_errors.add(error.hand);
    exact.add(error_of_exact_positions(rendered.recording(), rendered.truth()).object);
    white.add(error_of_white_positions(rendered.recording(), rendered.truth(), labels).object);
    progress.advance();
  }
  const auto name = fmt::format("{} of {}", activity, object);
  emit_object(name, object_errors, exact, white, goals_mm(activity), emit);
  emit_hand(name, hand_errors, emit);
  return object_errors;
}

void measure_scenes(const Emit& emit, Progress& progress) {
  Errors all_errors;
  std::uint64_t first = first_seed;
  for (const auto& [activity, object] : scenes) {
    all_errors.add(measure_scene(activity, object ? object : scene::default_object(activity).name,
                                 first, emit, progress));
    first += seeds;
  }
  emit_covariance("all scenes", all_errors, emit);
  emit_standard_errors("all scenes", all_errors, emit);
}

void measure_occlusion(const Emit& emit, Progress& progress) {
  for (const char* activity : covered_activities) {
    const RenderedRecording rendered({activity, scene::default_object(activity), first_seed});
    for (const char* tracker : occlusion_trackers) {
      emit(at_most(fmt::format("{}, {}: frames to find the object after an occlusion of 1 s",
                               activity, tracker),
                   frames_to_recover(rendered, tracker), "frames", 3.0));
      progress.advance();
    }
  }
}

void measure_glove_colored(const Emit& emit, Progress& progress) {
  for (const char* activity : gloved_activities) {
    const RenderedRecording rendered(
        {activity, with_glove_color(scene::default_object(activity)), first_seed});
    const auto error =
        compare_labels_with_truth(rendered.label("component"), rendered.truth()).object;
    const auto name = std::string(activity) + " of a ball of the glove's colour";
    emit(at_most(name + ": lost or wrong", 100.0 * (error.lost_share + error.wrong_share), "%",
                 5.0));
    emit(at_most(name + ": wrong without a flag", 100.0 * error.wrong_unsaid_share, "%", 0.5));
    emit(reported(name + ": flagged as following the hand", 100.0 * error.follows_share, "%"));
    progress.advance();
  }
}

}  // namespace

Verification verify_labels() {
  return [](const Emit& emit) {
    measure_smoothing(emit);
    Progress progress("recordings labelled",
                      seeds * scenes.size() +
                          covered_activities.size() * occlusion_trackers.size() +
                          gloved_activities.size() + tracker_trials());
    measure_scenes(emit, progress);
    measure_occlusion(emit, progress);
    measure_glove_colored(emit, progress);
    measure_trackers(emit, progress);
  };
}

}  // namespace touchtrace::study
