#include "tests/verify/recording/verify_recording.h"

#include <signal.h>
#include <sys/wait.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/random.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using Emit = std::function<void(Figure)>;

constexpr int timed_frames = 200;
constexpr int flips = 200, kills = 20;
constexpr int frames_of_an_hour = 72000;

CameraInfo camera_of(int width, int height) {
  CameraInfo camera;
  camera.width = width, camera.height = height;
  return camera;
}

/// Smooth shading with 2 counts of noise, depth with steps of 5 mm: as hard to pack as a real
/// image.
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

Recording recording_of(const CameraInfo& camera, int frames) {
  Recording recording;
  recording.activity = "wave";
  recording.camera = camera;
  recording.provenance = start_provenance("touchtrace/recording/1", "verify");
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
  writer.finish(recording_of(camera, frames));
}

void measure_speed(const ScratchFolder& folder, const Emit& emit) {
  const CameraInfo camera = camera_of(320, 240);
  std::vector<RgbdFrame> images;
  for (std::uint64_t seed = 0; seed < 8; ++seed) images.push_back(noisy_image(camera, seed));
  const fs::path path = folder.path() / "speed.h5";
  const Stopwatch writing;
  write(path, camera, images, timed_frames);
  emit(at_most("recording: write 320x240 colour and depth",
               1e3 * writing.cpu_seconds() / timed_frames, "CPU-ms", 6.0));
  emit(reported("recording: size of such a frame",
                static_cast<double>(fs::file_size(path)) / 1e3 / timed_frames, "kB"));
  const RecordingReader reader(path);
  const Stopwatch reading;
  for (std::size_t i = 0; i < timed_frames; ++i) reader.read_camera_frame(i);
  emit(at_most("recording: read such a frame", 1e3 * reading.cpu_seconds() / timed_frames, "CPU-ms",
               2.0));
}

/// An hour at 20 Hz must open at once: every verb opens its recordings.
void measure_opening(const ScratchFolder& folder, const Emit& emit) {
  const CameraInfo camera = camera_of(16, 12);
  const fs::path path = folder.path() / "hour.h5";
  write(path, camera, {noisy_image(camera, 1)}, frames_of_an_hour);
  const Stopwatch opening;
  const RecordingReader reader(path);
  emit(at_most("recording: open an hour", opening.cpu_seconds(), "CPU-s", 2.0));
}

/// Whether the small recording of `frames` frames still reads as `images` say.
bool reads_as(const fs::path& path, const std::vector<RgbdFrame>& images, int frames) {
  const RecordingReader reader(path);
  bool same = reader.recording().camera_times.host_time_s ==
              recording_of(reader.recording().camera, frames).camera_times.host_time_s;
  for (int i = 0; i < frames; ++i) {
    const RgbdFrame frame = reader.read_camera_frame(static_cast<std::size_t>(i));
    const RgbdFrame& image = images[static_cast<std::size_t>(i) % images.size()];
    same = same && frame.color == image.color && frame.depth == image.depth;
  }
  return same;
}

void measure_bit_flips(const ScratchFolder& folder, const Emit& emit) {
  const CameraInfo camera = camera_of(16, 12);
  const std::vector<RgbdFrame> images{noisy_image(camera, 1)};
  constexpr int frames = 8;
  const fs::path path = folder.path() / "flips.h5";
  write(path, camera, images, frames);
  std::string bytes = read_file(path);
  RandomStream random(1, "bit flips");
  int found = 0, silent = 0;
  for (int i = 0; i < flips; ++i) {
    const auto bit = random.below(8 * bytes.size());
    bytes[bit / 8] ^= static_cast<char>(1 << (bit % 8));
    std::ofstream(path, std::ios::binary) << bytes;
    bytes[bit / 8] ^= static_cast<char>(1 << (bit % 8));
    try {
      silent += !reads_as(path, images, frames);
    } catch (const Error&) {
      ++found;
    }
  }
  emit(reported("recording: bit flips found, of 200; the rest hit unused bytes", found, "flips"));
  emit(at_most("recording: bit flips that changed the content silently", silent, "flips", 0.0));
}

/// Kills a writer that replaces `path` again and again, after a random time.
void kill_a_writer(const fs::path& path, const CameraInfo& camera,
                   const std::vector<RgbdFrame>& images, int frames, double after_s) {
  const pid_t child = fork();
  if (child == 0)
    for (;;) write(path, camera, images, frames);
  usleep(static_cast<useconds_t>(1e6 * after_s));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

void measure_kills(const ScratchFolder& folder, const Emit& emit) {
  const CameraInfo camera = camera_of(64, 48);
  const std::vector<RgbdFrame> images{noisy_image(camera, 1)};
  constexpr int frames = 10;
  const fs::path path = folder.path() / "kills.h5";
  write(path, camera, images, frames);
  RandomStream random(1, "kills");
  int damaged = 0;
  for (int i = 0; i < kills; ++i) {
    kill_a_writer(path, camera, images, frames, random.uniform(0.01, 0.2));
    try {
      damaged += !reads_as(path, images, frames);
    } catch (const Error&) {
      ++damaged;
    }
  }
  emit(at_most("recording: files damaged by killing their writer, of 20", damaged, "files", 0.0));
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
