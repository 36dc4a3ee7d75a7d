#include "tests/verify/recording/file_content.h"

#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {
namespace {

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
  std::string take() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace

std::string content_of_recording(const std::filesystem::path& path) {
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
  return std::move(content).take();
}

std::string content_of_labels(const std::filesystem::path& path) {
  const Labels l = read_labels(path);
  Content content;
  content << l.activity << l.clips << l.time_s << l.clip << l.glove_frame << l.hand << l.object
          << l.raw.time_s << l.raw.clip << l.raw.hand_m << l.raw.object_m << l.raw.hand_sigma_m
          << l.raw.object_sigma_m << l.summary.dump() << nlohmann::json(l.provenance).dump();
  return std::move(content).take();
}

}  // namespace touchtrace
