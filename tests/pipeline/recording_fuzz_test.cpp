#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/random.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::put;
using testing::sample_labels;
using testing::sample_recording;
using testing::TemporaryFolder;

/// Contents of a file as bytes.
class Content {
 public:
  template <class T>
  Content& operator<<(const std::vector<T>& values) {
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return *this;
  }
  Content& operator<<(const std::string& text) { return bytes_ += text, *this; }
  Content& operator<<(double value) { return *this << std::vector<double>{value}; }
  Content& operator<<(const RgbdFrame& frame) {
    return *this << frame.color << frame.depth << frame.mask;
  }
  Content& operator<<(const std::vector<Clip>& clips) {
    for (const auto& clip : clips)
      *this << clip.start_s << clip.end_s << clip.object << clip.object_fell << clip.hand_box.x
            << clip.hand_box.height << clip.object_box.width
            << static_cast<double>(clip.box_frame.value_or(0));
    return *this;
  }
  Content& operator<<(const Truth::Body& body) {
    return *this << body.position_m << body.velocity_m_per_s << body.orientation_wxyz;
  }
  Content& operator<<(const LabelledBody& body) {
    return *this << body.position_m << body.velocity_m_per_s << body.covariance
                 << body.causal_position_m << body.causal_velocity_m_per_s << body.quality;
  }
  bool operator==(const Content&) const = default;

 private:
  std::string bytes_;
};

Content content_of_recording(const std::filesystem::path& path) {
  const RecordingReader reader(path);
  const Recording& r = reader.recording();
  Content content;
  content << r.activity << r.epoch_unix_s << r.clips << nlohmann::json(r.provenance).dump();
  for (const auto& glove : r.gloves) {
    const GloveInfo& info = glove.info;
    content << info.name << info.rows << info.rate_hz << info.bits << info.polarity << info.scan_s
            << info.baseline_counts << info.mask << info.taxel_position_m;
    content << glove.sequence << glove.host_time_s << glove.counts;
  }
  content << r.camera.rate_hz << r.camera.depth_unit_m << r.board.square_m
          << r.camera_times.sequence << r.camera_times.device_time_s << r.camera_times.host_time_s;
  for (double g : r.camera.gravity_m_per_s2.value()) content << g;
  for (std::size_t i = 0; i < r.camera_times.frames(); ++i) content << reader.read_camera_frame(i);
  for (std::size_t i = 0; i < reader.background_frames(); ++i) content << reader.read_background(i);
  for (std::size_t i = 0; i < reader.board_views(); ++i) content << reader.read_board_view(i);
  const Truth truth = read_truth(path);
  content << truth.time_s << truth.clip << truth.hand << truth.object << truth.contact_force_n
          << truth.calibration.dump() << truth.clocks.dump();
  for (const auto& event : truth.events) content << event.time_s << event.kind;
  return content;
}

Content content_of_labels(const std::filesystem::path& path) {
  const Labels l = read_labels(path);
  Content content;
  content << l.activity << l.clips << l.time_s << l.clip << l.glove_frame << l.hand << l.object
          << l.raw.time_s << l.raw.clip << l.raw.hand_m << l.raw.object_m << l.raw.hand_sigma_m
          << l.raw.object_sigma_m << l.summary.dump() << nlohmann::json(l.provenance).dump();
  return content;
}

/// Flips one bit at a time: the contents must be unchanged, or reading must throw data_error.
template <class ContentOf>
void flip_bits(const std::filesystem::path& original, int flips, ContentOf content_of) {
  const Content expected = content_of(original);
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
    try {
      const RecordingReader reader(path);
      for (std::size_t frame = 0; frame < reader.recording().camera_times.frames(); frame += 10)
        reader.read_camera_frame(frame);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::data) << "bit " << bit << ": " << error.what();
    }
  }
}

}  // namespace
}  // namespace touchtrace
