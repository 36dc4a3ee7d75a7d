#include "tests/verify/record/verify_record.h"

#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/random.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/acquire/glove/protocol.h"
#include "pipeline/acquire/record/recorder.h"
#include "pipeline/acquire/transport/transport.h"
#include "tests/verify/record/killed_recorder.h"
#include "tests/verify/record/live_latency.h"

namespace touchtrace {
namespace {

using Emit = std::function<void(Figure)>;

constexpr std::size_t log_header_bytes = 16;
constexpr int num_kills = 200, num_flips = 10'000, num_feeds = 200'000;

void measure_kills(const ScratchFolder& folder, const Emit& emit) {
  RandomStream random(1, "kills");
  std::uint64_t acknowledged = 0, lost = 0;
  int incomplete = 0;
  for (int i = 0; i < num_kills; ++i) {
    const KilledRecorder killed = kill_recorder(folder.path(), random.uniform(0.05, 0.6));
    acknowledged += killed.acknowledged_frames;
    if (killed.recovered_frames < killed.acknowledged_frames)
      lost += killed.acknowledged_frames - killed.recovered_frames;
    incomplete += !killed.is_complete;
  }
  emit(reported("record: acknowledged frames at 10x rate, 200 kills",
                static_cast<double>(acknowledged), "frames"));
  emit(at_most("record: acknowledged frames lost", static_cast<double>(lost), "frames", 0.0));
  emit(at_most("record: logs not recovered, of 200", incomplete, "logs", 0.0));
}

/// Payloads of a log; sets whether the reader says that it is damaged.
std::vector<std::vector<std::uint8_t>> read_log(const std::filesystem::path& path,
                                                bool& is_damaged) {
  LogReader reader(path);
  std::vector<std::vector<std::uint8_t>> payloads;
  while (const auto record = reader.next())
    payloads.emplace_back(record->payload.begin(), record->payload.end());
  is_damaged = !reader.damage().is_torn_only() || reader.damage().torn_bytes > 0;
  return payloads;
}

void measure_flips(const ScratchFolder& folder, const Emit& emit) {
  const auto path = folder.path() / "flips.log";
  RandomStream random(1, "log flips");
  {
    LogWriter log(path);
    for (int i = 0; i < 20; ++i) {
      std::vector<std::uint8_t> payload(random.below(200));
      for (auto& byte : payload) byte = static_cast<std::uint8_t>(random.below(256));
      log.append(RecordKind::glove_frame, payload);
    }
  }
  bool is_damaged = false;
  const auto expected = read_log(path, is_damaged);
  std::string bytes = read_file(path);
  int silent = 0;
  std::size_t max_lost = 0;
  for (int i = 0; i < num_flips; ++i) {
    const auto bit = 8 * log_header_bytes + random.below(8 * (bytes.size() - log_header_bytes));
    bytes[bit / 8] ^= static_cast<char>(1 << (bit % 8));
    std::ofstream(path, std::ios::binary) << bytes;
    bytes[bit / 8] ^= static_cast<char>(1 << (bit % 8));
    const auto found = read_log(path, is_damaged);
    silent += !is_damaged;
    max_lost = std::max(max_lost, expected.size() - found.size());
  }
  emit(at_most("record: flipped bits of a log without a warning, of 10000", silent, "flips", 0.0));
  emit(at_most("record: records lost by one flipped bit", static_cast<double>(max_lost), "records",
               1.0));
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

/// Camera of 640 x 480 pixels, colour and depth at 30 Hz.
class SteadyCamera : public RecordSource {
 public:
  bool step(const RecordSink& sink) override {
    std::this_thread::sleep_until(next_);
    next_ += std::chrono::microseconds(33'333);
    const double time_s = static_cast<double>(number_) / 30.0;
    const FrameStamp stamp{number_++, time_s, time_s};
    sink(RecordKind::color_image, to_payload(stamp, std::span<const std::uint8_t>(color_)));
    sink(RecordKind::depth_image, to_payload(stamp, std::span<const std::uint16_t>(depth_)));
    return true;
  }

 private:
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now();
  std::uint64_t number_ = 0;
  std::vector<std::uint8_t> color_ = std::vector<std::uint8_t>(3 * 640 * 480, 7);
  std::vector<std::uint16_t> depth_ = std::vector<std::uint16_t>(640 * 480, 1000);
};

void measure_load(const ScratchFolder& folder, const Emit& emit) {
  constexpr double duration_s = 10.0;
  SessionInfo session;
  session.provenance = start_provenance("touchtrace/recording/2", "record");
  SteadyCamera camera;
  const Stopwatch stopwatch;
  Recorder recorder(folder.path() / "load.log", session, {&camera});
  while (stopwatch.wall_seconds() < duration_s) recorder.step();
  recorder.finish();
  emit(at_most("record: 640x480 colour and depth at 30 Hz",
               100.0 * stopwatch.cpu_seconds() / stopwatch.wall_seconds(), "% of a core", 25.0));
  emit(at_most("record: frames that the disk was too slow for",
               static_cast<double>(recorder.discarded_frames()), "frames", 0.0));
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
    measure_flips(folder, emit);
    measure_load(folder, emit);
    measure_kills(folder, emit);
  };
}

}  // namespace touchtrace
