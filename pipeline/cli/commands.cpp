#include "pipeline/cli/commands.h"

namespace touchtrace::cli {

const Program& touchtrace_program() {
  static const Program program{
      "touchtrace",
      "touchtrace: from touch to trajectories",
      {doctor_command(), devices_command(), self_test_command(), plan_command(), tune_command(),
       objects_command(), assumptions_command(), simulate_command(), check_command(),
       send_command(), calibrate_command(), label_command(), train_command(), evaluate_command(),
       report_command()}};
  return program;
}

}  // namespace touchtrace::cli
