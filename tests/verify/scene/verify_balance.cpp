#include "pipeline/scene/person/activity.h"
#include "tests/verify/scene/balance_statistics.h"
#include "tests/verify/scene/verify_scene.h"

namespace touchtrace::scene {

void verify_balance(const std::function<void(Figure)>& emit) {
  constexpr double degrees = 57.29578;
  SceneOptions options;
  options.activity = "balance";
  options.object = default_object("balance");
  const BalanceStatistics s = balance_statistics(options, 40);
  emit(at_most("balance, 40 clips: fraction lost", s.lost_share, "", 0.05));
  emit(at_most("balance: lean, rms", degrees * s.lean_rms_rad, "deg", 5.0));
  emit(at_most("balance: lean, maximum", degrees * s.lean_max_rad, "deg", 20.0));
  emit(at_most("balance: hand from its mean, rms", s.hand_rms_m, "m", 0.15));
  emit(at_most("balance: hand from its mean, maximum", s.hand_max_m, "m", 0.4));
  emit(at_least("balance: fraction of the hand's power in 0.25-2.5 Hz", s.slow_share, "", 0.8));
  emit(reported("balance: moment through the foot, rms", s.moment_rms_nm, "N m"));
  emit(at_most("balance: residual of the moment that the motion needs", s.moment_residual, "",
               0.03));
  emit(reported("balance: centre of pressure over lean", s.pressure_m_per_rad, "m/rad"));
  emit(reported("balance: lean from the centre of pressure, R^2", s.pressure_r2, ""));
  options.parameters.balance.delay_s = 0.130;
  const BalanceStatistics late = balance_statistics(options, 10);
  emit(reported("balance with a delay of 130 ms: fraction lost", late.lost_share, ""));
  emit(reported("balance with a delay of 130 ms: hand from its mean, maximum", late.hand_max_m,
                "m"));
}

}  // namespace touchtrace::scene
