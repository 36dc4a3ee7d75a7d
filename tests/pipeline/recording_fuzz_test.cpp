#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/random.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"
#include "tests/verify/recording/file_content.h"

namespace touchtrace {
namespace {

using testing::put;
using testing::sample_labels;
using testing::sample_recording;
using testing::TemporaryFolder;

/// Flips one bit at a time: the contents must be unchanged, or reading must throw data_error.
template <class ContentOf>
void flip_bits(const std::filesystem::path& original, int flips, ContentOf content_of) {
  const std::string expected = content_of(original);
  std::string bytes = read_file(original);
  const auto flipped = original.string() + ".flipped";
  RandomStream random(3, "bit flips");
  int rejected = 0;
  for (int i = 0; i < flips; ++i) {
    const auto bit = random.below(8 * bytes.size());
    const auto flip = static_cast<char>(1 << (bit % 8));
    bytes[bit / 8] ^= flip;
    put(flipped, bytes);
    bytes[bit / 8] ^= flip;
    try {
      EXPECT_TRUE(content_of(flipped) == expected)
          << "bit " << bit << " changed the contents unnoticed";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::data) << "bit " << bit << ": " << error.what();
      ++rejected;
    }
  }
  EXPECT_GT(rejected, 0);
}

TEST(RecordingFuzz, BitFlipsAreDetectedOrHarmless) {
  const TemporaryFolder folder;
  auto sample = sample_recording(8);
  sample.recording.clips[1].box_frame = 15;
  write(sample, folder / "a.h5");
  flip_bits(folder / "a.h5", 300, content_of_recording);
}

TEST(RecordingFuzz, BitFlipsInLabelsAreDetectedOrHarmless) {
  const TemporaryFolder folder;
  write_labels(folder / "l.h5", sample_labels(sample_recording(8).recording), false);
  flip_bits(folder / "l.h5", 300, content_of_labels);
}

/// Flips bits of a file without checksums, which changes its contents, but must not crash.
TEST(RecordingFuzz, BitFlipsInFilesOfH5pyDoNotCrash) {
  const TemporaryFolder folder;
  const auto path = folder / "a.h5";
  ASSERT_EQ(std::system(fmt::format("/usr/bin/python3 {}/scripts/write_recording.py {}",
                                    TOUCHTRACE_SOURCE_DIR, path.string())
                            .c_str()),
            0);
  std::string bytes = read_file(path);
  RandomStream random(4, "bit flips");
  const auto metadata_bits = 8 * std::min<std::size_t>(bytes.size(), 1 << 15);
  for (int i = 0; i < 200; ++i) {
    const auto bit = random.below(i % 2 == 0 ? metadata_bits : 8 * bytes.size());
    bytes[bit / 8] ^= static_cast<char>(1 << (bit % 8));
    put(path, bytes);
    bytes[bit / 8] ^= static_cast<char>(1 << (bit % 8));
    testing::expect_read_or_refused([&] {
      const RecordingReader reader(path);
      for (std::size_t frame = 0; frame < reader.recording().camera_times.frames(); frame += 10)
        reader.read_camera_frame(frame);
    });
  }
}

}  // namespace
}  // namespace touchtrace
