#include <signal.h>
#include <sys/wait.h>

#include <cmath>
#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/recording/recording_file.h"
#include "tests/verify/recording/file_content.h"
#include "tests/verify/support/bit_flips.h"
#include "tests/verify/verifications.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using Emit = std::function<void(Figure)>;

constexpr int num_timed_frames = 200;
constexpr int num_flips = 10'000, num_kills = 20;
constexpr int frames_per_hour = 72000;

CameraInfo make_camera_info(int width, int height) {
  CameraInfo camera;
  camera.width = width, camera.height = height;
  return camera;
}

/// Smooth shading with noise of 2 counts, depth with noise in steps of 5 mm: compresses about as
/// well as a real image.
RgbdFrame noisy_image(const CameraInfo& camera, std::uint64_t seed) {
  RandomStream random(seed, "noisy image");
  RgbdFrame frame;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      for (int channel = 0; channel < 3; ++channel)
        frame.color.push_back(static_cast<std::uint8_t>(120 + 40 * std::sin(0.02 * x + channel) +
                                                        20 * std::cos(0.03 * y) +
                                                        2 * random.normal()));
      frame.depth.push_back(static_cast<std::uint16_t>(1100 + y + 5 * std::round(random.normal())));
    }
  return frame;
}

Recording make_recording(const CameraInfo& camera, int frames) {
  Recording recording;
  recording.activity = "wave";
  recording.camera = camera;
  recording.provenance = start_provenance("touchtrace/recording/2", "verify");
  for (int i = 0; i < frames; ++i) {
    recording.camera_times.sequence.push_back(static_cast<std::uint64_t>(i));
    recording.camera_times.device_time_s.push_back(i / camera.rate_hz);
    recording.camera_times.host_time_s.push_back(i / camera.rate_hz);
  }
  return recording;
}

void write(const fs::path& path, const CameraInfo& camera, const std::vector<RgbdFrame>& images,
           int frames) {
  RecordingWriter writer(path, camera, true);
  for (int i = 0; i < frames; ++i)
    writer.append_camera_frame(images[static_cast<std::size_t>(i) % images.size()]);
  writer.finish(make_recording(camera, frames));
}

void measure_speed(const ScratchFolder& folder, const Emit& emit) {
  const CameraInfo camera = make_camera_info(320, 240);
  std::vector<RgbdFrame> images;
  for (std::uint64_t seed = 0; seed < 8; ++seed) images.push_back(noisy_image(camera, seed));
  const fs::path path = folder.path() / "speed.h5";
  const Stopwatch writing;
  write(path, camera, images, num_timed_frames);
  emit(at_most("recording: write 320x240 colour and depth",
               1e3 * writing.cpu_seconds() / num_timed_frames, "CPU-ms", 6.0));
  emit(reported("recording: size of a 320x240 frame",
                static_cast<double>(fs::file_size(path)) / 1e3 / num_timed_frames, "kB"));
  const RecordingReader reader(path);
  const Stopwatch reading;
  for (std::size_t i = 0; i < num_timed_frames; ++i) reader.read_camera_frame(i);
  emit(at_most("recording: read 320x240 colour and depth",
               1e3 * reading.cpu_seconds() / num_timed_frames, "CPU-ms", 2.0));
}

/// An hour at 20 Hz must open quickly: every command opens its recordings.
void measure_opening(const ScratchFolder& folder, const Emit& emit) {
  const CameraInfo camera = make_camera_info(16, 12);
  const fs::path path = folder.path() / "hour.h5";
  write(path, camera, {noisy_image(camera, 1)}, frames_per_hour);
  const Stopwatch opening;
  const RecordingReader reader(path);
  emit(at_most("recording: open one hour", opening.cpu_seconds(), "CPU-s", 2.0));
}

/// True if the recording of `frames` frames reads back as written.
bool reads_back(const fs::path& path, const std::vector<RgbdFrame>& images, int frames) {
  const RecordingReader reader(path);
  bool same = reader.recording().camera_times.host_time_s ==
              make_recording(reader.recording().camera, frames).camera_times.host_time_s;
  for (int i = 0; i < frames; ++i) {
    const RgbdFrame frame = reader.read_camera_frame(static_cast<std::size_t>(i));
    const RgbdFrame& image = images[static_cast<std::size_t>(i) % images.size()];
    same = same && frame.color == image.color && frame.depth == image.depth;
  }
  return same;
}

/// Glove of 2 x 3 taxels that touches nothing.
GloveStream make_glove(int frames) {
  GloveStream glove;
  glove.info.rows = 2, glove.info.cols = 3;
  glove.info.baseline_counts.assign(6, 20.0f), glove.info.mask.assign(6, 1);
  glove.info.taxel_position_m.assign(18, 0.01f);
  for (int i = 0; i < frames; ++i) {
    glove.sequence.push_back(static_cast<std::uint64_t>(i));
    glove.host_time_s.push_back(i / glove.info.rate_hz);
    glove.counts.insert(glove.counts.end(), {20, 21, 22, 23, 24, 25});
  }
  return glove;
}

Truth make_truth(int samples) {
  const auto count = static_cast<std::size_t>(samples);
  Truth truth;
  for (int i = 0; i < samples; ++i) truth.time_s.push_back(0.01 * i);
  truth.clip.assign(count, 0);
  truth.hand.position_m.assign(3 * count, 0.5);
  truth.hand.velocity_m_per_s.assign(3 * count, 0.25);
  for (std::size_t i = 0; i < 4 * count; ++i)
    truth.hand.orientation_wxyz.push_back(i % 4 == 0 ? 1.0 : 0.0);
  truth.object = truth.hand;
  truth.contact_force_n.assign(3 * count, 0.0);
  truth.events = {{0.1, "release"}};
  truth.calibration = truth.clocks = {{"offset_s", 0.0}};
  return truth;
}

/// All that a recording can contain.
void write_whole(const fs::path& path) {
  constexpr int frames = 8;
  CameraInfo camera = make_camera_info(16, 12);
  camera.gravity_m_per_s2 = {0.0, 9.81, 0.0};
  const RgbdFrame image = noisy_image(camera, 1);
  Recording recording = make_recording(camera, frames);
  recording.clips = {{0.0, 0.4, "ball", false, {1, 2, 3, 4}, {4, 1, 3, 3}}};
  recording.gloves = {make_glove(frames)};
  RecordingWriter writer(path, camera, true);
  for (int i = 0; i < frames; ++i) writer.append_camera_frame(image);
  writer.append_background(image), writer.append_board_view(image);
  writer.write_truth(make_truth(20));
  writer.finish(recording);
}

void measure_bit_flips(const ScratchFolder& folder, const Emit& emit) {
  const fs::path path = folder.path() / "flips.h5";
  write_whole(path);
  const BitFlips flips = flip_bits(path, num_flips, [&] { return content_of_recording(path); });
  emit(reported("recording: flipped bits detected, of 10000; the others hit unused bytes",
                flips.detected, "flips"));
  emit(at_most("recording: flipped bits that changed the content silently", flips.silent, "flips",
               0.0));
}

/// Starts a process that replaces `path` repeatedly, and kills it after `after_s`.
void kill_writer(const fs::path& path, const CameraInfo& camera,
                 const std::vector<RgbdFrame>& images, int frames, double after_s) {
  const pid_t child = fork();
  if (child == 0)
    for (;;) write(path, camera, images, frames);
  usleep(static_cast<useconds_t>(1e6 * after_s));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

void measure_kills(const ScratchFolder& folder, const Emit& emit) {
  const CameraInfo camera = make_camera_info(64, 48);
  const std::vector<RgbdFrame> images{noisy_image(camera, 1)};
  constexpr int frames = 10;
  const fs::path path = folder.path() / "kills.h5";
  write(path, camera, images, frames);
  RandomStream random(1, "kills");
  int damaged = 0;
  for (int i = 0; i < num_kills; ++i) {
    kill_writer(path, camera, images, frames, random.uniform(0.01, 0.2));
    try {
      damaged += !reads_back(path, images, frames);
    } catch (const Error&) {
      ++damaged;
    }
  }
  emit(at_most("recording: files damaged by killing the writer, of 20", damaged, "files", 0.0));
}

}  // namespace

Verification verify_recording() {
  return [](const Emit& emit) {
    const ScratchFolder folder;
    measure_speed(folder, emit);
    measure_opening(folder, emit);
    measure_bit_flips(folder, emit);
    measure_kills(folder, emit);
  };
}

}  // namespace touchtrace
