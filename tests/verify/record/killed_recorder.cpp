#include "tests/verify/record/killed_recorder.h"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <new>

#include "pipeline/acquire/record/convert_log.h"
#include "pipeline/acquire/record/glove_source.h"
#include "pipeline/acquire/record/recorder.h"
#include "pipeline/recording/recording_file.h"
#include "tests/support/pseudo_terminal.h"

namespace touchtrace {
namespace {

using Counter = std::atomic<std::uint64_t>;

const GloveProtocol& protocol() { return find_glove_protocol("mit-rows"); }

/// Counter in memory that a child process shares.
class SharedCounter {
 public:
  SharedCounter()
      : page_(mmap(nullptr, sizeof(Counter), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1,
                   0)) {
    new (page_) Counter(0);
  }
  ~SharedCounter() { munmap(page_, sizeof(Counter)); }
  SharedCounter(const SharedCounter&) = delete;
  SharedCounter& operator=(const SharedCounter&) = delete;

  Counter& operator*() const { return *static_cast<Counter*>(page_); }

 private:
  void* page_;
};

[[noreturn]] void record_until_killed(const std::string& port, const std::filesystem::path& log,
                                      Counter& acknowledged) {
  SessionInfo session;
  session.glove = protocol().usual_glove;
  session.provenance = start_provenance("touchtrace/recording/2", "record");
  GloveSource glove(protocol(), *session.glove, {port}, monotonic_s());
  Recorder recorder(log, session, {&glove});
  for (;;) {
    recorder.step();
    acknowledged = recorder.written_frames();
  }
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
  const SharedCounter acknowledged;
  const pid_t child = fork();
  if (child == 0) record_until_killed(device.path(), log, *acknowledged);
  while (!std::filesystem::exists(log)) usleep(1000);
  send_frames(device, monotonic_s() + after_s);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  const LogConversion conversion = convert_log(log, output, true);
  RecordingReader::validate(output);
  return {*acknowledged, conversion.glove_frames, conversion.is_complete()};
}

}  // namespace touchtrace
