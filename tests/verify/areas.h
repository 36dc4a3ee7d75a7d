#pragma once

#include "pipeline/cli/command.h"

namespace touchtrace::verify {

/// Program touchtrace-verify: one command per area.
const cli::Program& verify_program();

}  // namespace touchtrace::verify
