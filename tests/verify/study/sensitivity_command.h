#pragma once

#include "pipeline/cli/command.h"

namespace touchtrace::study {

/// Halves and doubles the scene's parameters, and measures what that does to L1@50.
cli::Command sensitivity_command();

}  // namespace touchtrace::study
