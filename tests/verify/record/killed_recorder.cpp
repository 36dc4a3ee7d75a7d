#include "tests/verify/record/killed_recorder.h"

#include <sys/mman.h>

#include <atomic>
#include <memory>
#include <new>
#include <thread>

#include "engine/base/random.h"
#include "pipeline/acquire/record/convert_log.h"
#include "pipeline/acquire/record/glove_source.h"
#include "pipeline/acquire/record/recorder.h"
#include "pipeline/recording/recording_file.h"
#include "tests/support/pseudo_terminal.h"
#include "tests/verify/record/child_program.h"

namespace touchtrace {
namespace {

const GloveProtocol& protocol() { return find_glove_protocol("mit-rows"); }

/// Value in memory that child processes share.
template <class T>
class Shared {
 public:
  Shared()
      : page_(mmap(nullptr, sizeof(T), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    new (page_) T();
  }
  ~Shared() { munmap(page_, sizeof(T)); }
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;

  T& operator*() const { return *static_cast<T*>(page_); }

 private:
  void* page_;
};

using Counter = std::atomic<std::uint64_t>;
struct Counters {
  Counter acknowledged = 0, lost = 0, complete = 0;
};

/// Records until `is_over` with the number of written frames is true.
template <class IsOver>
void record_while(const std::string& port, const std::filesystem::path& log, double start_s,
                  IsOver&& is_over) {
  SessionInfo session;
  session.glove = protocol().usual_glove;
  session.provenance = start_provenance("touchtrace/recording/2", "record");
  GloveSource glove(protocol(), *session.glove, {port}, start_s);
  Recorder recorder(log, session, {&glove});
  do recorder.step();
  while (!is_over(recorder.written_frames()));
}

void send_frames(const testing::PseudoTerminal& device, double end_s) {
  GloveStream glove;
  glove.info = protocol().usual_glove;
  glove.sequence = {0};
  glove.counts.resize(static_cast<std::size_t>(glove.info.taxels()));
  for (; monotonic_s() < end_s; ++glove.sequence[0]) {
    glove.counts[0] = static_cast<std::uint16_t>(glove.sequence[0] % 4096);
    device.send(protocol().encode(glove, 0));
    usleep(10'000);
  }
}

}  // namespace

KilledRecorder kill_recorder(const std::filesystem::path& folder, double after_s) {
  const auto log = folder / "killed.h5.log", output = folder / "killed.h5";
  std::filesystem::remove(log);
  const testing::PseudoTerminal device;
  const Shared<Counter> acknowledged;
  const pid_t child = fork();
  if (child == 0)
    record_while(device.path(), log, monotonic_s(), [&](std::uint64_t frames) {
      *acknowledged = frames;
      return false;
    });
  while (!std::filesystem::exists(log)) usleep(1000);
  send_frames(device, monotonic_s() + after_s);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  KilledRecorder killed{*acknowledged};
  try {
    const LogConversion conversion = convert_log(log, output, true);
    RecordingReader::validate(output);
    killed.recovered_frames = conversion.glove_frames;
    killed.is_complete = conversion.is_complete();
  } catch (const Error&) {
    killed.is_complete = killed.acknowledged_frames == 0;  // killed before the first frame
  }
  return killed;
}

KillCounts kill_recorders(const std::filesystem::path& folder, int kills, int processes) {
  const Shared<Counters> counters;
  std::vector<std::unique_ptr<Child>> children;
  for (int process = 0; process < processes; ++process)
    children.push_back(std::make_unique<Child>([&, process] {
      const auto own_folder = folder / std::to_string(process);
      std::filesystem::create_directory(own_folder);
      RandomStream random(static_cast<std::uint64_t>(process), "kills");
      for (int i = process; i < kills; i += processes) {
        const KilledRecorder killed = kill_recorder(own_folder, random.uniform(0.05, 0.6));
        (*counters).acknowledged += killed.acknowledged_frames;
        (*counters).lost += killed.acknowledged_frames -
                            std::min(killed.acknowledged_frames, killed.recovered_frames);
        (*counters).complete += killed.is_complete;
      }
      return 0;
    }));
  for (const auto& child : children) child->wait();
  return {(*counters).acknowledged, (*counters).lost,
          static_cast<std::uint64_t>(kills) - (*counters).complete};
}

void record_for(const std::filesystem::path& log, double start_s, double duration_s) {
  const testing::PseudoTerminal device;
  std::jthread sender([&] { send_frames(device, start_s + duration_s); });
  record_while(device.path(), log, start_s,
               [&](std::uint64_t) { return monotonic_s() > start_s + duration_s; });
}

}  // namespace touchtrace
