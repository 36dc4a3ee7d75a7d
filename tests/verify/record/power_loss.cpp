#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <thread>

#include "engine/base/files.h"
#include "engine/base/random.h"
#include "pipeline/acquire/record/convert_log.h"
#include "pipeline/acquire/record/session.h"
#include "pipeline/acquire/transport/transport.h"
#include "tests/verify/record/killed_recorder.h"
#include "tests/verify/record/verify_record.h"

namespace touchtrace {
namespace {

/// Successful call of fdatasync: size of the file before it, and the time after it.
struct Sync {
  std::uint64_t bytes;
  double completed_s;
};
std::vector<Sync> syncs;
int num_synced_folders = 0;

int sync_file(int file, long call) {
  struct stat status {};
  fstat(file, &status);
  const int result = static_cast<int>(syscall(call, file));
  if (S_ISDIR(status.st_mode)) ++num_synced_folders;
  if (call == SYS_fdatasync && result == 0)
    syncs.push_back({static_cast<std::uint64_t>(status.st_size), monotonic_s()});
  return result;
}

}  // namespace
}  // namespace touchtrace

// In place of the C library's, in this program.
extern "C" int fdatasync(int file) { return touchtrace::sync_file(file, SYS_fdatasync); }
extern "C" int fsync(int file) { return touchtrace::sync_file(file, SYS_fsync); }

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr double recording_s = 20.0;
constexpr int num_losses = 1000, losses_per_conversion = 50;
constexpr std::size_t block_bytes = 4096;

struct RecordedFrame {
  std::string payload;
  double arrival_s = 0.0;    ///< on the clock of monotonic_s()
  std::size_t end_byte = 0;  ///< in the log
};

/// Glove frames of a log by their numbers.
std::map<std::uint64_t, RecordedFrame> read_frames(const fs::path& log, double start_s) {
  std::map<std::uint64_t, RecordedFrame> frames;
  LogReader reader(log);
  while (const auto record = reader.next()) {
    FrameStamp stamp{};
    if (record->kind != RecordKind::glove_frame || record->payload.size() < sizeof stamp) continue;
    std::memcpy(&stamp, record->payload.data(), sizeof stamp);
    frames[stamp.sequence] = {{record->payload.begin(), record->payload.end()},
                              stamp.host_time_s + start_s,
                              reader.position()};
  }
  return frames;
}

/// File after a loss of power: `bytes` were written, of which `synced` are on the disk.
std::string after_power_loss(std::string_view bytes, std::size_t synced, RandomStream& random) {
  if (random.below(2) == 0)
    return std::string(bytes.substr(0, synced + random.below(bytes.size() - synced + 1)));
  std::string left(bytes);
  for (std::size_t block = synced / block_bytes; block * block_bytes < left.size(); ++block) {
    const auto fate = random.below(3);
    const std::size_t begin = std::max(synced, block * block_bytes),
                      end = std::min(left.size(), (block + 1) * block_bytes);
    for (std::size_t i = begin; fate > 0 && i < end; ++i)
      left[i] = fate == 1 ? '\0' : static_cast<char>(random.below(256));
  }
  return left;
}

}  // namespace

void measure_power_losses(const fs::path& folder, const std::function<void(Figure)>& emit) {
  const fs::path log = folder / "power.log", damaged = folder / "damaged.log";
  syncs.clear(), num_synced_folders = 0;
  const double start_s = monotonic_s();
  record_for(log, start_s, recording_s);
  emit(at_least("record: synchronised the folder of a new log", num_synced_folders, "times", 1.0));
  const auto frames = read_frames(log, start_s);
  const std::string bytes = read_file(log);
  RandomStream random(1, "power losses");
  double max_lost_s = 0.0;
  int wrong = 0, not_converted = 0;
  for (int i = 0; i < num_losses; ++i) {
    const double time_s = random.uniform(start_s + 2.0, start_s + recording_s);
    std::size_t synced = 0, written = 0;
    for (const Sync& sync : syncs)
      if (sync.completed_s <= time_s) synced = sync.bytes;
    for (const auto& [number, frame] : frames)
      if (frame.arrival_s <= time_s) written = std::max(synced, frame.end_byte);
    std::ofstream(damaged, std::ios::binary)
        << after_power_loss(std::string_view(bytes).substr(0, written), synced, random);
    const auto found = read_frames(damaged, start_s);
    for (const auto& [number, frame] : found)
      wrong += !frames.contains(number) || frames.at(number).payload != frame.payload;
    for (const auto& [number, frame] : frames)
      if (frame.arrival_s <= time_s && !found.contains(number)) {
        max_lost_s = std::max(max_lost_s, time_s - frame.arrival_s);
        break;
      }
    if (i % losses_per_conversion > 0) continue;
    const auto conversion = convert_log(damaged, folder / "damaged.h5", true);
    not_converted += conversion.glove_frames != found.size();
  }
  emit(within("record: lost by a loss of power, worst of 1000", max_lost_s, "s", 1e-3, 1.0));
  emit(at_most("record: frames that were not recorded, after it", wrong, "frames", 0.0));
  emit(at_most("record: logs not recovered after it, of 20", not_converted, "logs", 0.0));
}

}  // namespace touchtrace
