#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/sweep/run_cells.h"

namespace touchtrace::sweep {

/// Job array of Slurm whose tasks run the shards of a study.
struct SlurmArray {
  std::filesystem::path root;          ///< folder of the cells
  std::vector<std::string> arguments;  ///< command line of a task; "--shard" is added
  int tasks = 1;
  std::vector<std::string> options;  ///< of sbatch, e.g. "--time=60"
};

/// Shell script for sbatch.
std::string job_script(const SlurmArray& array);

/// Submits the array with sbatch, follows it with squeue, and submits it again while cells are
/// neither done nor failed, as after a time limit. Prints the messages of failed cells. An
/// interrupt cancels the job and is thrown. Throws failure if Slurm refuses the job, if squeue does
/// not answer for ten minutes (the job is left running), or if several submissions in a row finish
/// no cell.
SweepSummary run_on_slurm(const std::vector<Cell>& cells, const SlurmArray& array);

}  // namespace touchtrace::sweep
