#pragma once

#include "pipeline/cli/verb.h"

namespace touchtrace::study {

/// Halves and doubles the scene's parameters, and measures what that does to L1@50.
cli::Verb sensitivity_command();

}  // namespace touchtrace::study
