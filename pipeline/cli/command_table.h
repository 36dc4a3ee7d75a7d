#pragma once

#include "pipeline/sweep/command_table.h"

namespace touchtrace::cli {

/// The commands of `touchtrace` for a study.
sweep::CommandTable command_table();

}  // namespace touchtrace::cli
