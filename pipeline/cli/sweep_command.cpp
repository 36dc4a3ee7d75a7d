#include <fmt/core.h>

#include "pipeline/cli/command_table.h"
#include "pipeline/cli/commands.h"
#include "pipeline/sweep/collect.h"
#include "pipeline/sweep/manifest.h"
#include "pipeline/sweep/prediction.h"
#include "pipeline/sweep/run_cells.h"
#include "pipeline/sweep/slurm.h"

namespace touchtrace::cli {
namespace {

using nlohmann::json;

struct SweepOptions {
  std::string study, output, shard;
  std::vector<std::string> axes, changes;
  int jobs = 1;
  bool dry_run = false;
  std::string launcher = "local";
  int tasks = 1;
  std::vector<std::string> sbatch;
};

void describe(OptionSet& set, SweepOptions& o) {
  set.input("study", o.study,
            "stages with their options (.toml), see pipeline/sweep/README.md, or commands such as "
            "train+evaluate");
  set.inputs("axes", o.axes, "[STAGE.]OPTION=VALUES, as --set").required = false;
  set.path("output", o.output, "folder of the cells and results; several machines may share it")
      .value("DIR");
  set.texts("set", o.changes, "options in place of the study's, e.g. train.seed=1:5")
      .value("STAGE.OPTION=VALUES");
  set.flag("dry-run", o.dry_run, "check the study, print its cells and the predicted time");
  set.integer("jobs", o.jobs, "cells that run at a time", 1, 1024);
  set.text("shard", o.shard, "run part I of N of every stage's cells, with what they need")
      .value("I/N");
  set.group("Slurm");
  set.choice("launcher", o.launcher, "slurm: run the shards as a job array", {"local", "slurm"});
  set.integer("tasks", o.tasks, "tasks of the array", 1, 10'000);
  set.texts("sbatch", o.sbatch, "options of sbatch, e.g. --sbatch=--time=60 --sbatch=--mem=8G");
}

std::string time_text(const json& seconds) {
  if (seconds.is_null()) return "unknown";
  const auto whole = static_cast<long>(seconds.get<double>() + 0.5);
  return fmt::format("{}:{:02d}:{:02d}", whole / 3600, whole / 60 % 60, whole % 60);
}

void print_prediction(const json& rows) {
  fmt::print("{:<16} {:>7} {:>7} {:>12}\n", "stage", "cells", "done", "time left");
  for (const json& row : rows)
    fmt::print("{:<16} {:>7} {:>7} {:>12}\n", row["stage"].get<std::string>(),
               row["cells"].get<int>(), row["done"].get<int>(),
               time_text(row["predicted_seconds"]));
}

std::vector<std::string> task_arguments(const SweepOptions& o) {
  std::vector<std::string> arguments{"sweep",  o.study,  "--output",
                                     o.output, "--jobs", std::to_string(o.jobs)};
  for (const auto& change : o.changes) arguments.push_back("--set=" + change);
  return arguments;
}

sweep::SweepSummary launch(const SweepOptions& o, const std::vector<sweep::Cell>& cells,
                           const std::vector<bool>& selected) {
  return o.launcher == "slurm"
             ? sweep::run_on_slurm(cells, {o.output, task_arguments(o), o.tasks, o.sbatch})
             : sweep::run_cells(cells, selected, static_cast<std::size_t>(o.jobs));
}

void require_success(const sweep::SweepSummary& summary) {
  if (summary.failed == 0) return;
  throw failure(fmt::format("{} cells failed, {} that need them were skipped", summary.failed,
                            summary.skipped),
                "correct the cause and run the same command again: finished cells are kept");
}

ExitCode predict(const SweepOptions& options, const std::vector<sweep::Cell>& cells,
                 const std::vector<bool>& selected, bool as_json) {
  const json rows = sweep::predict(
      cells, selected, options.output,
      static_cast<std::size_t>(options.jobs) * static_cast<std::size_t>(options.tasks));
  if (as_json)
    fmt::print("{}\n", json{{"stages", rows}}.dump(2));
  else
    print_prediction(rows);
  return ExitCode::done;
}

void print_results(json results, const sweep::SweepSummary& summary, const std::string& folder,
                   bool as_json) {
  if (as_json) {
    results.update({{"done", summary.done},
                    {"reused", summary.reused},
                    {"failed", summary.failed},
                    {"skipped", summary.skipped}});
    fmt::print("{}\n", results.dump(2));
  } else {
    fmt::print("{}\n{} cells done, {} reused; results in {}\n", results["table"].get<std::string>(),
               summary.done, summary.reused, folder);
  }
}

ExitCode run(const SweepOptions& given, const Invocation& invocation) {
  SweepOptions options = given;
  options.changes.insert(options.changes.begin(), given.axes.begin(), given.axes.end());
  if (options.launcher == "slurm" && !options.shard.empty())
    throw usage_error("--launcher slurm cannot be combined with --shard", "give --tasks N");
  if (options.launcher != "slurm" && (options.tasks != 1 || !options.sbatch.empty()))
    throw usage_error("--tasks and --sbatch need --launcher slurm",
                      "give --launcher slurm, or --jobs N for parallel cells on this machine");
  if (std::filesystem::is_regular_file(options.output))
    throw usage_error(fmt::format("--output: {} is a file", options.output), "give a folder");
  const auto commands = command_table();
  const auto cells = sweep::expand(sweep::read_study(options.study, options.changes, commands),
                                   commands, options.output);
  const auto selected = sweep::cells_of(
      options.shard.empty() ? sweep::Shard{} : sweep::parse_shard(options.shard), cells);
  if (options.dry_run) return predict(options, cells, selected, invocation.json);
  sweep::write_manifest(options.output, cells);
  const auto summary = launch(options, cells, selected);
  print_results(sweep::collect(options.output, {}), summary, options.output, invocation.json);
  require_success(summary);
  return ExitCode::done;
}

}  // namespace

Command sweep_command() {
  return make_command<SweepOptions>(
      "sweep", "run a study: commands over grids of options, resumable and shared by machines",
      {"touchtrace sweep scripts/studies/quick.toml --output out/quick --dry-run",
       "touchtrace sweep scripts/studies/quick.toml --output out/quick --jobs 2",
       "touchtrace sweep train+evaluate recording=a.h5 resolution=32,16 seed=1:5 --output out",
       "touchtrace sweep study.toml --output out --set train.seed=1:5 train.resolution=32,16,8",
       "touchtrace sweep study.toml --output shared/out --shard 1/4"},
      run, {.quiet = true});
}

}  // namespace touchtrace::cli
