#include "pipeline/cli/verbs.h"

namespace touchtrace::cli {

const Program& touchtrace_program() {
  static const Program program{
      "touchtrace",
      "touchtrace: from touch to trajectories",
      {doctor_verb(), devices_verb(), self_test_verb(), plan_verb(), tune_verb(), objects_verb(),
       assumptions_verb(), simulate_verb(), check_verb(), send_verb(), calibrate_verb(),
       label_verb(), train_verb(), evaluate_verb(), report_verb()}};
  return program;
}

}  // namespace touchtrace::cli
