#include "tests/verify/record/verify_record.h"

#include <fmt/core.h>

#include <cmath>

#include "engine/base/random.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/acquire/glove/protocol.h"
#include "tests/verify/record/killed_recorder.h"
#include "tests/verify/record/live_latency.h"
#include "tests/verify/verifications.h"

namespace touchtrace {
namespace {

using Emit = std::function<void(Figure)>;

constexpr int num_kills = 1000, kill_processes = 4, num_feeds = 200'000;

void measure_kills(const ScratchFolder& folder, const Emit& emit) {
  const KillCounts counts = kill_recorders(folder.path(), num_kills, kill_processes);
  emit(reported("record: acknowledged frames at 10x rate, 1000 kills",
                static_cast<double>(counts.acknowledged_frames), "frames"));
  emit(at_most("record: acknowledged frames lost", static_cast<double>(counts.lost_frames),
               "frames", 0.0));
  emit(at_most("record: logs not recovered, of 1000", static_cast<double>(counts.incomplete_logs),
               "logs", 0.0));
}

/// Pieces of random bytes and of valid frames, in random order.
void measure_random_bytes(const Emit& emit) {
  std::uint64_t feeds = 0, disordered = 0;
  for (const GloveProtocol& protocol : glove_protocols()) {
    RandomStream random(1, protocol.name);
    GloveStream glove;
    glove.info = protocol.usual_glove;
    glove.sequence = {0};
    for (int i = 0; i < glove.info.taxels(); ++i)
      glove.counts.push_back(static_cast<std::uint16_t>(random.below(1u << glove.info.bits)));
    const std::string valid = protocol.encode(glove, 0) + protocol.encode(glove, 0);
    std::uint64_t last = 0, frames = 0;
    const auto parser = protocol.parse(glove.info, [&](const GloveFrame& frame) {
      disordered += frames++ > 0 && frame.sequence <= last;
      last = frame.sequence;
    });
    std::vector<std::uint8_t> piece;
    for (int i = 0; i < num_feeds; ++i, ++feeds) {
      piece.resize(random.below(std::min<std::size_t>(valid.size(), 200)));
      const bool is_valid = random.below(2) == 0;
      const std::size_t at = random.below(valid.size() - piece.size());
      for (std::size_t k = 0; k < piece.size(); ++k)
        piece[k] = static_cast<std::uint8_t>(is_valid ? valid[at + k] : random.below(256));
      parser->feed(piece, i);
    }
  }
  emit(reported("record: random pieces parsed without a crash", static_cast<double>(feeds),
                "pieces"));
  emit(at_most("record: frames out of order in them", static_cast<double>(disordered), "frames",
               0.0));
}

double milliseconds(const std::vector<double>& sorted_s, std::size_t percent) {
  return sorted_s.empty() ? std::nan("") : 1e3 * sorted_s[sorted_s.size() * percent / 100];
}

/// At the glove's rate and at ten times that.
void measure_live_predictions(const ScratchFolder& folder, const Emit& emit) {
  for (const auto& [rate_hz, frames] : {std::pair(15.0, 600), {150.0, 6000}}) {
    const LiveLatency latency = measure_live_latency(folder.path(), rate_hz, frames);
    const auto& seconds = latency.seconds;
    const auto at_rate = fmt::format("live: byte to band at {:g} Hz, one core busy", rate_hz);
    emit(within(at_rate + ", median", milliseconds(seconds, 50), "ms", 0.0, 2.0));
    emit(within(at_rate + ", 99 %", milliseconds(seconds, 99), "ms", 0.0, 10.0));
    emit(reported("live: of that in the program, median", milliseconds(latency.program_seconds, 50),
                  "ms"));
    emit(reported("live: of that in the program, 99 %", milliseconds(latency.program_seconds, 99),
                  "ms"));
    emit(at_most(fmt::format("live: frames without a line, of {}", frames),
                 static_cast<double>(frames) - static_cast<double>(seconds.size()), "frames", 0.0));
  }
  const RowComparison comparison = compare_live_with_recorded(folder.path());
  emit(at_least("live: rows compared with predict --recording",
                static_cast<double>(comparison.compared), "rows", 500.0));
  emit(at_most("live: rows that differ in a bit", static_cast<double>(comparison.unequal), "rows",
               0.0));
}

}  // namespace

Verification verify_record() {
  return [](const Emit& emit) {
    const ScratchFolder folder;
    measure_live_predictions(folder, emit);
    measure_random_bytes(emit);
    measure_flips(folder.path(), emit);
    measure_load(folder.path(), emit);
    measure_full_disk(folder.path(), emit);
    measure_power_losses(folder.path(), emit);
    measure_kills(folder, emit);
  };
}

}  // namespace touchtrace
