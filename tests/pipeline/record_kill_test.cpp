// A process that records is killed; the log must hold every frame that it had written.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>

#include "pipeline/acquire/record/convert_log.h"
#include "pipeline/acquire/record/glove_source.h"
#include "pipeline/acquire/record/recorder.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/pseudo_terminal.h"

namespace touchtrace {
namespace {

using testing::PseudoTerminal;
using testing::TemporaryFolder;

const GloveProtocol& protocol() { return find_glove_protocol("mit-rows"); }

/// Counter in memory that a child process shares.
class SharedCounter {
 public:
  SharedCounter()
      : page_(mmap(nullptr, sizeof(Value), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1,
                   0)) {
    new (page_) Value(0);
  }
  ~SharedCounter() { munmap(page_, sizeof(Value)); }
  SharedCounter(const SharedCounter&) = delete;
  SharedCounter& operator=(const SharedCounter&) = delete;

  std::atomic<std::uint64_t>& operator*() const { return *static_cast<Value*>(page_); }

 private:
  using Value = std::atomic<std::uint64_t>;
  void* page_;
};

[[noreturn]] void record_until_killed(const std::string& port, const std::filesystem::path& log,
                                      std::atomic<std::uint64_t>& acknowledged) {
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

/// Sends frames at 100 Hz, ten times the device's rate, until `end_s`.
void send_frames(const PseudoTerminal& device, double end_s) {
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

/// Number of kills: 5, or that of the environment for a long run.
int num_kills() {
  const char* text = std::getenv("TOUCHTRACE_KILLS");
  return text ? std::atoi(text) : 5;
}

TEST(RecordKill, NoAcknowledgedFrameIsLost) {
  RandomStream random(static_cast<std::uint64_t>(getpid()), "kills");
  std::uint64_t all_acknowledged = 0;
  for (int i = 0; i < num_kills(); ++i) {
    const TemporaryFolder folder;
    const PseudoTerminal device;
    const SharedCounter acknowledged;
    const pid_t child = fork();
    if (child == 0) record_until_killed(device.path(), folder / "a.log", *acknowledged);
    while (!std::filesystem::exists(folder / "a.log")) usleep(1000);
    send_frames(device, monotonic_s() + random.uniform(0.2, 0.6));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const auto conversion = convert_log(folder / "a.log", folder / "a.h5", false);
    EXPECT_GE(conversion.glove_frames, *acknowledged);
    EXPECT_GT(conversion.glove_frames, 0u);
    EXPECT_TRUE(conversion.is_complete());
    RecordingReader::validate(folder / "a.h5");
    all_acknowledged += *acknowledged;
  }
  EXPECT_GT(all_acknowledged, 0u);
  RecordProperty("acknowledged_frames", std::to_string(all_acknowledged));
}

}  // namespace
}  // namespace touchtrace
