#include "pipeline/cli/verbs.h"

namespace touchtrace::cli {

const std::vector<Verb>& verbs() {
  static const std::vector<Verb> table{
      doctor_verb(),    devices_verb(),     self_test_verb(), plan_verb(),     tune_verb(),
      objects_verb(),   assumptions_verb(), simulate_verb(),  check_verb(),    send_verb(),
      calibrate_verb(), label_verb(),       train_verb(),     evaluate_verb(), sensitivity_verb(),
      verify_verb(),    report_verb(),
  };
  return table;
}

}  // namespace touchtrace::cli
