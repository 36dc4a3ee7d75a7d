#pragma once

#include "pipeline/cli/command.h"

namespace touchtrace::verify {

/// touchtrace-verify: one command per area, and the study of the scene's parameters.
const cli::Program& verify_program();

}  // namespace touchtrace::verify
