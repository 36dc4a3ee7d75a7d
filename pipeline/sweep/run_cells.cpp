#include "pipeline/sweep/run_cells.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "engine/base/logged_process.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "pipeline/sweep/claim.h"

namespace touchtrace::sweep {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr auto poll_period = std::chrono::milliseconds(50);
constexpr auto renewal_period = std::chrono::seconds(5);
constexpr auto look_period = std::chrono::seconds(1);  // at cells of other processes
constexpr std::size_t message_lines = 3;
constexpr std::streamoff max_message_bytes = 16384;

enum class State { waiting, running, done, failed, skipped };

/// Last lines of a log; empty if it cannot be read.
std::string message_of(const fs::path& log) {
  std::ifstream stream(log, std::ios::ate);
  stream.seekg(std::max<std::streamoff>(0, stream.tellg() - max_message_bytes));
  const std::string end{std::istreambuf_iterator<char>(stream), {}};
  std::vector<std::string> lines = split_text(end, '\n');
  std::erase_if(lines, [](const auto& line) { return line.empty(); });
  if (lines.size() > message_lines) lines.erase(lines.begin(), lines.end() - message_lines);
  return fmt::format("{}", fmt::join(lines, "\n"));
}

/// "--resume" if an earlier run of the cell left a checkpoint or a folder of finished files.
std::vector<std::string> child_arguments(const Cell& cell) {
  std::vector<std::string> arguments{cell.command};
  if (cell.can_resume &&
      (fs::exists(cell.output.string() + ".checkpoint") || fs::is_directory(cell.output)))
    arguments.emplace_back("--resume");
  arguments.insert(arguments.end(), cell.arguments.begin(), cell.arguments.end());
  return arguments;
}

std::optional<fs::file_time_type> failure_time(const Cell& cell) {
  std::error_code missing;
  const auto time = fs::last_write_time(cell.failure(), missing);
  return missing ? std::nullopt : std::optional(time);
}

/// A cell that this process runs.
class RunningCell {
 public:
  RunningCell(const Cell& cell, std::unique_ptr<Claim> claim)
      : cell_(cell), claim_(std::move(claim)) {
    fs::remove(cell.failure());
    const json description{{"stage", cell.stage},
                           {"command", cell.command},
                           {"axes", cell.axes},
                           {"options", cell.options},
                           {"version", cell.version}};
    write_file(cell.folder / "cell.json", description.dump(1) + "\n", true);
    process_.emplace(child_arguments(cell), stdout_file(), cell_.log());
  }

  /// New state of the cell.
  State poll() {
    if (Clock::now() >= next_renewal_)
      claim_->renew(), next_renewal_ = Clock::now() + renewal_period;
    const auto result = process_->poll();
    if (!result) return State::running;
    return result->succeeded() ? finish(*result) : fail(*result);
  }
  void interrupt() { process_->interrupt(); }

 private:
  fs::path stdout_file() const { return cell_.folder / "stdout.txt"; }

  State finish(const ChildResult& result) const {
    write_file(
        cell_.folder / "seconds.json",
        json{{"wall_seconds", result.wall_seconds}, {"cpu_seconds", result.cpu_seconds}}.dump(),
        true);
    const auto printed = read_file(stdout_file());
    write_file(cell_.result(), printed.empty() ? "null\n" : printed, true);
    fs::remove(stdout_file());
    return State::done;
  }

  State fail(const ChildResult& result) const {
    const auto message = message_of(cell_.log());
    write_file(cell_.failure(), message.empty() ? result.ending() : message, true);
    return State::failed;
  }

  const Cell& cell_;
  std::unique_ptr<Claim> claim_;
  std::optional<LoggedProcess> process_;
  Clock::time_point next_renewal_ = Clock::now() + renewal_period;
};

class Run {
 public:
  Run(const std::vector<Cell>& cells, const std::vector<bool>& selected, std::size_t jobs)
      : cells_(cells), jobs_(jobs), states_(cells.size(), State::waiting) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      old_failures_.push_back(failure_time(cells[i]));
      if (!selected[i]) continue;
      if (cells[i].is_done())
        states_[i] = State::done, ++summary_.reused;
      else
        pending_.push_back(i);
    }
  }

  SweepSummary run() {
    Progress progress("cells", pending_.size());
    try {
      while (!pending_.empty()) {
        throw_if_interrupted();
        looks_ = Clock::now() >= next_look_;
        if (looks_) next_look_ = Clock::now() + look_period;
        std::erase_if(pending_, [&](std::size_t i) { return is_settled(i, progress); });
        std::this_thread::sleep_for(poll_period);
      }
    } catch (...) {
      for (const auto& [cell, running] : running_) running->interrupt();
      throw;
    }
    return summary_;
  }

 private:
  /// Advances a cell. Returns whether it is done, failed or skipped.
  bool is_settled(std::size_t i, Progress& progress) {
    const State state = states_[i] == State::running ? running_.at(i)->poll() : next_state(i);
    states_[i] = state;
    if (state == State::waiting || state == State::running) return false;
    if (running_.erase(i) > 0) next_look_ = {};
    if (state == State::done) ++summary_.done;
    if (state == State::skipped) ++summary_.skipped;
    if (state == State::failed) ++summary_.failed, report_failed(cells_[i]);
    progress.advance(1, cells_[i].name());
    return true;
  }

  State next_state(std::size_t i) {
    const auto& inputs = cells_[i].inputs;
    const auto any = [&](State state) {
      return std::ranges::any_of(inputs,
                                 [&](std::size_t input) { return states_[input] == state; });
    };
    if (any(State::failed) || any(State::skipped)) return State::skipped;
    if (any(State::waiting) || any(State::running) || !looks_) return State::waiting;
    if (cells_[i].is_done()) return State::done;
    if (const auto time = failure_time(cells_[i]); time && time != old_failures_[i])
      return State::failed;
    return running_.size() < jobs_ ? start(i) : State::waiting;
  }

  State start(std::size_t i) {
    auto claim = claims_.take(cells_[i].folder);
    if (!claim) return State::waiting;
    if (cells_[i].is_done()) return State::done;  // by another process, just before the claim
    running_[i] = std::make_unique<RunningCell>(cells_[i], std::move(claim));
    return State::running;
  }

  const std::vector<Cell>& cells_;
  std::size_t jobs_;
  std::vector<State> states_;
  std::vector<std::size_t> pending_;
  std::vector<std::optional<fs::file_time_type>> old_failures_;  ///< these are tried again
  std::map<std::size_t, std::unique_ptr<RunningCell>> running_;
  Claims claims_;
  Clock::time_point next_look_;  ///< at files of cells that this process does not run
  bool looks_ = true;
  SweepSummary summary_;
};

}  // namespace

Shard parse_shard(const std::string& text) {
  const auto parts = split_text(text, '/');
  Shard shard;
  if (parts.size() != 2 || !parse_whole(parts[0], shard.index) ||
      !parse_whole(parts[1], shard.count) || shard.index < 1 || shard.index > shard.count)
    throw usage_error(fmt::format("'{}' is not a shard", text), "give I/N, e.g. 1/4 to 4/4");
  --shard.index;
  return shard;
}

std::vector<bool> cells_of(const Shard& shard, const std::vector<Cell>& cells) {
  std::vector<bool> selected(cells.size());
  std::map<std::string, std::size_t> counts;
  for (std::size_t i = 0; i < cells.size(); ++i)
    selected[i] = counts[cells[i].stage]++ % shard.count == shard.index;
  for (std::size_t i = cells.size(); i-- > 0;)
    if (selected[i])
      for (const std::size_t input : cells[i].inputs) selected[input] = true;
  return selected;
}

void report_failed(const Cell& cell) {
  Progress::warn(fmt::format("failed: {}\n{}\nlog: {}", cell.name(), message_of(cell.failure()),
                             cell.log().string()));
}

SweepSummary run_cells(const std::vector<Cell>& cells, const std::vector<bool>& selected,
                       std::size_t jobs) {
  return Run(cells, selected, jobs).run();
}

}  // namespace touchtrace::sweep
