#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/sweep/command_table.h"
#include "pipeline/sweep/study_file.h"

namespace touchtrace::sweep {

/// Stages of a study that is given as commands, such as "simulate+train+evaluate", without options;
/// nullopt if `study` is the name of a file.
std::optional<std::vector<StageTable>> parse_command_chain(const std::string& study);

/// "KEY=VALUES" with the first stage whose command has this option: "STAGE.KEY=VALUES". Throws
/// usage_error if none has it.
std::string name_stage(const std::string& change, const std::vector<StageTable>& stages,
                       const CommandTable& commands);

/// Sets the inputs that were not given to outputs of earlier stages, or to the same files as
/// theirs; `evaluate` takes all models of a `train` stage together.
void link_stages(std::vector<StageTable>& stages);

}  // namespace touchtrace::sweep
