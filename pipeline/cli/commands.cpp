#include "pipeline/cli/commands.h"

namespace touchtrace::cli {

const Program& touchtrace_program() {
  static const Program program{
      "touchtrace",
      "touchtrace predicts the motion of a hand and its object from a tactile glove. It calibrates "
      "an RGB-D camera, labels its video, and trains and evaluates the model on any OpenCL device.",
      {{"Set up", {doctor_command(), devices_command(), self_test_command(), generate_command()}},
       {"Simulate", {simulate_command(), objects_command(), parameters_command(), send_command()}},
       {"Process",
        {record_command(), recover_command(), glove_command(), import_command(), check_command(),
         calibrate_command(), mark_command(), label_command(), smooth_command(), train_command(),
         evaluate_command(), predict_command(), export_command(), report_command()}},
       {"Study", {plan_command(), sweep_command(), collect_command()}}},
      {{"sensitivity",
        {"a study", "run `touchtrace sweep scripts/studies/glove_parameters.toml --output DIR`"}},
       {"verify",
        {"touchtrace-verify",
         "build the target touchtrace-verify and run `touchtrace-verify --list`"}}}};
  return program;
}

}  // namespace touchtrace::cli
