#pragma once

#include "pipeline/cli/verb.h"

namespace touchtrace::cli {

/// The program `touchtrace`: one row per command.
const Program& touchtrace_program();

// One file a verb: <name>_verb.cpp.
Verb assumptions_verb();
Verb calibrate_verb();
Verb check_verb();
Verb devices_verb();
Verb doctor_verb();
Verb evaluate_verb();
Verb label_verb();
Verb objects_verb();
Verb plan_verb();
Verb report_verb();
Verb self_test_verb();
Verb send_verb();
Verb simulate_verb();
Verb train_verb();
Verb tune_verb();

}  // namespace touchtrace::cli
