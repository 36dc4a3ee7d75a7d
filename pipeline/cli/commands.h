#pragma once

#include "pipeline/cli/command.h"

namespace touchtrace::cli {

/// The program `touchtrace` with its table of commands.
const Program& touchtrace_program();

// Each in <name>_command.cpp:
Command parameters_command();
Command calibrate_command();
Command check_command();
Command collect_command();
Command devices_command();
Command doctor_command();
Command evaluate_command();
Command export_command();
Command generate_command();
Command glove_command();
Command import_command();
Command label_command();
Command mark_command();
Command objects_command();
Command plan_command();
Command predict_command();
Command record_command();
Command recover_command();
Command report_command();
Command self_test_command();
Command send_command();
Command simulate_command();
Command smooth_command();
Command sweep_command();
Command train_command();

}  // namespace touchtrace::cli
