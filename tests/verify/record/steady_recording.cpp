#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <thread>

#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "engine/base/provenance.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/acquire/record/glove_source.h"
#include "pipeline/acquire/record/recorder.h"
#include "tests/support/pseudo_terminal.h"
#include "tests/verify/record/live_rows.h"
#include "tests/verify/record/verify_record.h"
#include "tests/verify/verifications.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double camera_hz = 30.0, glove_hz = 15.0, hour_s = 3600.0, hours = 8.0,
                 hours_speed = 10.0;

const GloveProtocol& protocol() { return find_glove_protocol("mit-rows"); }

auto seconds(double value) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(value));
}

class SteadyCamera : public RecordSource {
 public:
  SteadyCamera(double duration_s, double speed)
      : num_images_(static_cast<std::uint64_t>(duration_s * camera_hz)), speed_(speed) {}

  bool step(const RecordSink& sink) override {
    if (number_ >= num_images_) return false;
    const double time_s = static_cast<double>(number_) / camera_hz;
    std::this_thread::sleep_until(start_ + seconds(time_s / speed_));
    const FrameStamp stamp{number_, time_s, time_s};
    sink(RecordKind::color_image, to_payload(stamp, std::span<const std::uint8_t>(color_)));
    sink(RecordKind::depth_image, to_payload(stamp, std::span<const std::uint16_t>(depth_)));
    ++number_;
    return true;
  }
  /// Pairs of colour and depth that were delivered.
  std::uint64_t delivered() const { return number_; }

 private:
  std::uint64_t num_images_;
  double speed_;
  Clock::time_point start_ = Clock::now();
  std::atomic<std::uint64_t> number_ = 0;
  std::vector<std::uint8_t> color_ = std::vector<std::uint8_t>(3 * 640 * 480, 7);
  std::vector<std::uint16_t> depth_ = std::vector<std::uint16_t>(640 * 480, 1000);
};

/// Resident memory, median of each hour.
class MemoryLog {
 public:
  void sample(double time_s) {
    const auto hour = static_cast<std::size_t>(time_s / hour_s);
    if (hour >= samples_.size()) samples_.resize(hour + 1);
    double total = 0.0, resident = 0.0;
    std::ifstream("/proc/self/statm") >> total >> resident;
    samples_[hour].push_back(resident * static_cast<double>(sysconf(_SC_PAGESIZE)));
  }
  std::vector<double> medians() {
    std::vector<double> medians;
    for (auto& hour : samples_) {
      std::ranges::sort(hour);
      if (!hour.empty()) medians.push_back(hour[hour.size() / 2]);
    }
    return medians;
  }

 private:
  std::vector<std::vector<double>> samples_;
};

/// Glove at the end of a pseudo-terminal.
class SteadyGlove {
 public:
  void start(double duration_s, double speed) {
    sender_ =
        std::jthread([=, this](const std::stop_token& stop) { send(stop, duration_s, speed); });
  }
  const std::string& path() const { return device_.path(); }
  std::uint64_t sent() const { return sent_; }
  void stop() { sender_.request_stop(), sender_.join(); }

 private:
  void send(const std::stop_token& stop, double duration_s, double speed) {
    const GloveStream glove = wavy_glove(32, 32, 100, glove_hz);
    const auto start = Clock::now();
    const auto num_frames = static_cast<std::uint64_t>(duration_s * glove_hz);
    for (std::uint64_t i = 0; i < num_frames && !stop.stop_requested(); sent_ = ++i) {
      std::this_thread::sleep_until(start + seconds(static_cast<double>(i) / glove_hz / speed));
      device_.send(protocol().encode(glove, i % glove.frames()));
    }
  }

  testing::PseudoTerminal device_;
  std::atomic<std::uint64_t> sent_ = 0;
  std::jthread sender_;
};

/// Removes what was written to a log since the last call.
class WrittenPart {
 public:
  explicit WrittenPart(const fs::path& log) : file_(open(log.c_str(), O_RDWR | O_CLOEXEC)) {}
  ~WrittenPart() { close(file_); }
  WrittenPart(const WrittenPart&) = delete;
  WrittenPart& operator=(const WrittenPart&) = delete;

  void remove(std::uint64_t log_bytes) {
    const auto end = static_cast<off_t>(log_bytes / 4096 * 4096);
    if (end > removed_)
      fallocate(file_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, removed_, end - removed_);
    removed_ = end;
  }

 private:
  int file_;
  off_t removed_ = 0;
};

struct TemporaryFile {
  fs::path path;
  ~TemporaryFile() { fs::remove(path); }
};

/// Folder in memory, if there is one: disks may be slower than ten times a camera's rate.
fs::path fast_folder(const fs::path& otherwise) {
  const fs::path memory = "/dev/shm";
  return access(memory.c_str(), W_OK) == 0 ? memory : otherwise;
}

struct SteadyRecording {
  double wall_s = 0.0, cpu_s = 0.0, duration_s = 0.0;  ///< duration_s: recorded
  std::uint64_t discarded_frames = 0;                  ///< because the disk was too slow
  std::uint64_t missing_frames = 0;                    ///< sent by a device, but not in the log
  std::vector<double> memory_bytes;                    ///< resident; median of each recorded hour
};

/// Records at `speed` times the rates of measure_load(). With a speed above 1, what was written is
/// removed from the log at once, because 8 hours would need 1.3 TB. Ctrl-C ends it.
SteadyRecording record_steadily(const fs::path& folder, double duration_s, double speed) {
  const TemporaryFile file{folder / fmt::format("touchtrace-{}.log", getpid())};
  const fs::path& log = file.path;
  SessionInfo session;
  session.provenance = start_provenance("touchtrace/recording/2", "record");
  SteadyGlove device;
  GloveSource glove(protocol(), protocol().usual_glove, {device.path()}, monotonic_s());
  const Stopwatch stopwatch;
  SteadyCamera camera(duration_s, speed);
  Recorder recorder(log, session, {&glove, &camera});
  device.start(duration_s, speed);
  WrittenPart written(log);
  MemoryLog memory;
  const auto minutes = static_cast<std::uint64_t>(std::ceil(duration_s / 60.0));
  Progress progress("recorded minutes", minutes);
  double next_sample_s = 0.0, next_minute_s = 60.0;
  const auto step = [&] {
    recorder.step();
    if (speed > 1.0) written.remove(recorder.log_bytes());
  };
  while (!interrupted() && stopwatch.wall_seconds() * speed < duration_s) {
    step();
    if (stopwatch.wall_seconds() < next_sample_s) continue;
    memory.sample(stopwatch.wall_seconds() * speed);
    next_sample_s = stopwatch.wall_seconds() + 1.0;
    for (; next_minute_s <= stopwatch.wall_seconds() * speed; next_minute_s += 60.0)
      progress.advance();
  }
  clear_interrupt();
  SteadyRecording result;
  result.wall_s = stopwatch.wall_seconds(), result.cpu_s = stopwatch.cpu_seconds();
  result.duration_s = static_cast<double>(camera.delivered()) / camera_hz;
  device.stop();
  for (int i = 0; i < 5; ++i) step();  // what is on its way
  recorder.finish();
  result.discarded_frames = recorder.discarded_frames();
  result.missing_frames = 2 * camera.delivered() + device.sent() - recorder.written_frames();
  result.memory_bytes = memory.medians();
  return result;
}

}  // namespace

void measure_load(const fs::path& folder, const std::function<void(Figure)>& emit) {
  const SteadyRecording load = record_steadily(folder, 10.0, 1.0);
  emit(at_most("record: 640x480 colour and depth at 30 Hz, glove at 15 Hz",
               100.0 * load.cpu_s / load.wall_s, "% of a core", 25.0));
  emit(at_most("record: frames that the disk was too slow for",
               static_cast<double>(load.discarded_frames), "frames", 0.0));
  emit(at_most("record: frames of both devices that are not in the log",
               static_cast<double>(load.missing_frames), "frames", 0.0));
}

Verification verify_hours() {
  return [](const std::function<void(Figure)>& emit) {
    const ScratchFolder folder;
    const SteadyRecording load =
        record_steadily(fast_folder(folder.path()), hours * hour_s, hours_speed);
    const auto [low, high] = std::ranges::minmax(load.memory_bytes);
    emit(reported("record: recorded time", load.duration_s / hour_s, "hours"));
    emit(
        at_least("record: speed", load.duration_s / load.wall_s, "times real", 0.99 * hours_speed));
    emit(at_most("record: frames of both devices that are not in the log",
                 static_cast<double>(load.missing_frames), "frames", 0.0));
    emit(at_most("record: processor", 100.0 * load.cpu_s / load.duration_s, "% of a core", 25.0));
    emit(reported("record: resident memory", 1e-6 * low, "MB"));
    emit(at_most("record: change of memory between hours", 100.0 * (high / low - 1.0), "%", 5.0));
  };
}

}  // namespace touchtrace
