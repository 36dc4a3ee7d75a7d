#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "engine/base/files.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_disk.h"

namespace touchtrace {
namespace {

using testing::exit_code_on_small_disk;
using testing::put;
using testing::sample_labels;
using testing::sample_recording;
using testing::TemporaryFolder;

std::size_t files_in(const TemporaryFolder& folder) {
  const std::filesystem::directory_iterator files(folder.path());
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

TEST(RecordingWriting, FullDiskFailsAndLeavesNoFile) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  write(sample, folder / "whole.h5");
  const auto whole_bytes = std::filesystem::file_size(folder / "whole.h5");
  std::filesystem::remove(folder / "whole.h5");
  for (int part = 0; part < 10; ++part) {
    const auto free_bytes = whole_bytes * part / 10;
    EXPECT_EQ(exit_code_on_small_disk(free_bytes, [&] { write(sample, folder / "a.h5"); }),
              static_cast<int>(ExitCode::failed))
        << free_bytes << " bytes";
    EXPECT_EQ(files_in(folder), 0u) << free_bytes << " bytes";
  }
  EXPECT_EQ(exit_code_on_small_disk(whole_bytes - 1, [&] { write(sample, folder / "a.h5"); }),
            static_cast<int>(ExitCode::failed));
  // While writing, the library needs more space than the final file.
  EXPECT_EQ(exit_code_on_small_disk(2 * whole_bytes, [&] { write(sample, folder / "a.h5"); }), 0);
}

TEST(RecordingWriting, FullDiskKeepsTheOldFile) {
  const TemporaryFolder folder;
  const Labels labels = sample_labels(sample_recording().recording);
  write_labels(folder / "l.h5", labels, false);
  const std::string before = read_file(folder / "l.h5");
  EXPECT_EQ(exit_code_on_small_disk(before.size() / 2,
                                    [&] { write_labels(folder / "l.h5", labels, true); }),
            static_cast<int>(ExitCode::failed));
  EXPECT_EQ(read_file(folder / "l.h5"), before);
  EXPECT_EQ(files_in(folder), 1u);
}

TEST(RecordingWriting, OverwritesOnlyOnRequest) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  put(folder / "a.h5", "precious");
  EXPECT_THROW(write(sample, folder / "a.h5"), Error);
  EXPECT_THROW(write_labels(folder / "a.h5", sample_labels(sample.recording), false), Error);
  EXPECT_EQ(read_file(folder / "a.h5"), "precious");
  EXPECT_NO_THROW(write(sample, folder / "a.h5", true, true));
}

TEST(RecordingWriting, InterruptedWriterLeavesNoFile) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  {
    RecordingWriter writer(folder / "a.h5", sample.recording.camera, false);
    writer.append_camera_frame(sample.frames[0]);
    writer.append_board_view(sample.board[0]);
    writer.write_truth(sample.truth);
  }
  EXPECT_EQ(files_in(folder), 0u);
}

TEST(RecordingWriting, KilledWriterLeavesNoFinalFile) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  const pid_t child = fork();
  if (child == 0) {
    RecordingWriter writer(folder / "a.h5", sample.recording.camera, false);
    for (const auto& frame : sample.frames) writer.append_camera_frame(frame);
    raise(SIGKILL);
  }
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.h5"));
  EXPECT_NO_THROW(write(sample, folder / "a.h5"));
}

TEST(RecordingWriting, RejectsInconsistentSizes) {
  const TemporaryFolder folder;
  auto sample = sample_recording();
  sample.frames[2].color.pop_back();
  EXPECT_THROW(write(sample, folder / "a.h5"), Error);
  sample = sample_recording();
  sample.frames.pop_back();
  EXPECT_THROW(write(sample, folder / "a.h5"), Error);
  sample = sample_recording();
  sample.recording.gloves[0].counts.pop_back();
  sample.recording.camera_times.host_time_s.pop_back();
  const auto fault =
      testing::expect_error([&] { write(sample, folder / "a.h5"); },
                            "/glove0/counts: expected 1140 elements, found 1139", {});
  EXPECT_NE(fault.find("/depth/host_time_s: expected"), std::string::npos) << fault;
  sample = sample_recording();
  sample.recording.gloves.resize(3, sample.recording.gloves[0]);
  EXPECT_THROW(write(sample, folder / "a.h5"), Error);
  sample = sample_recording();
  sample.truth.contact_force_n.pop_back();
  EXPECT_THROW(write(sample, folder / "a.h5"), Error);
  Labels labels = sample_labels(sample.recording);
  labels.hand.covariance.pop_back();
  EXPECT_THROW(write_labels(folder / "l.h5", labels, false), Error);
  EXPECT_EQ(files_in(folder), 0u);
}

}  // namespace
}  // namespace touchtrace
