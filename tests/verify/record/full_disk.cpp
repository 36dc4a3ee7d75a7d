#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include "engine/base/files.h"
#include "pipeline/acquire/glove/protocol.h"
#include "pipeline/recording/recording_file.h"
#include "tests/verify/record/child_program.h"
#include "tests/verify/record/live_rows.h"
#include "tests/verify/record/verify_record.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t disk_bytes = 1'048'576, log_bytes_per_frame = 32 + 24 + 2048;
constexpr int done_code = static_cast<int>(ExitCode::done);

/// In a file system that only this process sees.
bool mount_small_disk(const fs::path& folder) {
  return (unshare(CLONE_NEWNS) == 0 || unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0) &&
         mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=1m") == 0;
}

void limit_files(rlim_t bytes) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  limit.rlim_cur = bytes;
  setrlimit(RLIMIT_FSIZE, &limit);
}

/// Exit code of `record`, or -1 if `recover` failed.
int record_and_recover(const fs::path& disk, const fs::path& glove, const fs::path& output,
                       const fs::path& messages) {
  if (!mount_small_disk(disk)) limit_files(disk_bytes);
  const int file = open(messages.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600);
  dup2(file, STDOUT_FILENO), dup2(file, STDERR_FILENO);
  const std::string recording = disk / "full.h5";
  const int code = run_touchtrace({"record", "--glove", glove, "--protocol", "actionsense",
                                   "--speed", "0", "--output", recording});
  limit_files(RLIM_INFINITY);
  return run_touchtrace({"recover", recording + ".log", "--output", output}) == done_code ? code
                                                                                          : -1;
}

}  // namespace

void measure_full_disk(const fs::path& folder, const std::function<void(Figure)>& emit) {
  const fs::path disk = folder / "disk", output = folder / "full.h5",
                 messages = folder / "full.txt";
  fs::create_directory(disk);
  const GloveStream glove = wavy_glove(32, 32, 2 * disk_bytes / log_bytes_per_frame, 15.0);
  std::string bytes;
  for (std::size_t i = 0; i < glove.frames(); ++i) bytes += encode_actionsense(glove, i);
  write_file(folder / "full.bin", bytes, true);
  const int code =
      Child([&] { return record_and_recover(disk, folder / "full.bin", output, messages); }).wait();
  emit(within("record: exit code on a full disk", code, "", 1.0, 1.0));
  const bool has_hint = read_file(messages).find("touchtrace recover") != std::string::npos;
  emit(at_least("record: says how to recover the log", has_hint, "", 1.0));
  const GloveStream kept = RecordingReader(output).recording().gloves.at(0);
  const bool is_prefix = std::equal(kept.counts.begin(), kept.counts.end(), glove.counts.begin());
  emit(at_least("record: frames kept by a full disk of 1 MB",
                is_prefix ? static_cast<double>(kept.frames()) : 0.0, "frames",
                static_cast<double>((disk_bytes - 8192) / log_bytes_per_frame)));
}

}  // namespace touchtrace
