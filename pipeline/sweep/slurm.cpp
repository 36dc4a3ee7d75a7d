#include "pipeline/sweep/slurm.h"

#include <fmt/core.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <thread>

#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "engine/base/progress.h"

namespace touchtrace::sweep {
namespace {

namespace fs = std::filesystem;
constexpr int max_submissions_without_progress = 5;
constexpr auto poll_period = std::chrono::seconds(10);
constexpr int max_squeue_failures = 60;  // in a row; ten minutes

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

struct ShellResult {
  int exit_code = -1;
  std::string output, errors;  ///< stdout, stderr
};

/// `errors`: file for stderr.
ShellResult run_shell(const std::string& command, const fs::path& errors) {
  FILE* pipe = popen((command + " </dev/null 2>" + quoted(errors.string())).c_str(), "r");
  if (!pipe) throw failure("cannot start " + command, "check the limits of processes (ulimit -a)");
  ShellResult result;
  std::array<char, 4096> buffer;
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    result.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  result.errors = read_file(errors);
  return result;
}

/// Returns the number of the job.
std::string submit(const fs::path& script, const fs::path& errors) {
  const auto result = run_shell("sbatch --parsable " + quoted(script.string()), errors);
  auto job = result.output.substr(0, result.output.find_first_of(";\n"));
  const bool is_number = !job.empty() && job.find_first_not_of("0123456789") == std::string::npos;
  if (result.exit_code != 0 || !is_number)
    throw failure(
        fmt::format("sbatch refused {}: {}{}", script.string(), result.output, result.errors),
        "correct --sbatch, or see `sinfo`");
  return job;
}

/// Whether tasks of the job are pending or running. An unreachable controller counts as yes; throws
/// failure at the last of max_squeue_failures. `failures`: such answers in a row.
bool is_queued(const std::string& job, const fs::path& errors, int& failures) {
  const auto result = run_shell("squeue --noheader --format=%T --jobs=" + job, errors);
  if (result.exit_code == 0) failures = 0;
  if (result.exit_code == 0) return !result.output.empty();
  if (++failures == max_squeue_failures)
    throw failure(fmt::format("squeue does not answer: {}", result.errors),
                  fmt::format("job {} is left running; once Slurm answers, run the same command "
                              "again: finished cells are kept",
                              job));
  return result.errors.find("Invalid job id") == std::string::npos;
}

void wait_for_next_poll() {
  const auto end = std::chrono::steady_clock::now() + poll_period;
  while (std::chrono::steady_clock::now() < end) {
    throw_if_interrupted();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

std::size_t count_done(const std::vector<Cell>& cells) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cells, [](const Cell& cell) { return cell.is_done(); }));
}

void follow(const std::string& job, const fs::path& errors, const std::vector<Cell>& cells,
            std::size_t& done, Progress& progress) {
  int failures = 0;
  try {
    while (is_queued(job, errors, failures)) {
      wait_for_next_poll();
      const auto now_done = count_done(cells);
      progress.advance(now_done - done, "job " + job);
      done = now_done;
    }
  } catch (const Error&) {
    if (interrupted()) run_shell("scancel " + job, errors);
    throw;
  }
}

/// Counts failed and skipped cells; the others that are not done have been cut off.
SweepSummary settled(const std::vector<Cell>& cells) {
  SweepSummary summary;
  std::vector<bool> is_lost(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto& inputs = cells[i].inputs;
    const bool failed = !cells[i].is_done() && fs::exists(cells[i].failure());
    const bool skipped =
        std::ranges::any_of(inputs, [&](std::size_t input) { return is_lost[input]; });
    is_lost[i] = failed || skipped;
    summary.done += cells[i].is_done();
    summary.failed += failed;
    summary.skipped += skipped && !failed;
  }
  return summary;
}

}  // namespace

std::string job_script(const SlurmArray& array) {
  std::string text = fmt::format(
      "#!/bin/sh\n#SBATCH --job-name=touchtrace\n#SBATCH --array=1-{}\n#SBATCH --output=\"{}\"\n",
      array.tasks, (array.root / "slurm-%A_%a.log").string());
  for (const auto& option : array.options) text += "#SBATCH " + option + "\n";
  text += "exec " + quoted(fs::read_symlink("/proc/self/exe").string());
  for (const auto& argument : array.arguments) text += " " + quoted(argument);
  return text + fmt::format(" --shard \"$SLURM_ARRAY_TASK_ID/{}\"\n", array.tasks);
}

SweepSummary run_on_slurm(const std::vector<Cell>& cells, const SlurmArray& array) {
  const fs::path script = array.root / "slurm.sh", errors = array.root / "slurm.err";
  write_file(script, job_script(array), true);
  for (const Cell& cell : cells) fs::remove(cell.failure());  // tried again
  std::size_t done = count_done(cells);
  const std::size_t reused = done;
  Progress progress("cells", cells.size() - done);
  SweepSummary summary;
  for (int without_progress = 0; done + summary.failed + summary.skipped < cells.size();) {
    const std::size_t before = done;
    follow(submit(script, errors), errors, cells, done, progress);
    done = count_done(cells);
    summary = settled(cells);
    without_progress = done > before ? 0 : without_progress + 1;
    if (without_progress == max_submissions_without_progress)
      throw failure(fmt::format("{} job arrays in a row finished no cell", without_progress),
                    fmt::format("see {}/slurm-*.log; a longer --sbatch=--time=MINUTES may help",
                                array.root.string()));
  }
  for (const Cell& cell : cells)
    if (!cell.is_done() && fs::exists(cell.failure())) report_failed(cell);
  summary.done = done - reused, summary.reused = reused;
  return summary;
}

}  // namespace touchtrace::sweep
