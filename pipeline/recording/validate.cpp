#include "pipeline/recording/validate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "pipeline/recording/recording_schema.h"

namespace touchtrace {
namespace {

constexpr int max_rows = 4096;  // of taxels; also columns
constexpr int max_image_size = 16384;
constexpr double max_rate_hz = 1e5;
constexpr std::uint64_t max_counted_frames = 100'000'000;
constexpr double max_clip_time_s = 1e6;

/// Faults of the group at `path`.
class Validator {
 public:
  Validator(FileFaults& faults, std::string path) : faults_(faults), path_(std::move(path)) {}

  Validator group(const std::string& name) const { return {faults_, path_ + "/" + name}; }
  bool has_fault(const std::string& dataset) const {
    return faults_.contains(path_ + "/" + dataset);
  }

  void require(bool condition, const std::string& dataset, const std::string& fault) const {
    faults_.require(condition, path_ + "/" + dataset, fault);
  }
  void require_attribute(bool condition, const std::string& name, const std::string& fault) const {
    faults_.require(condition, attribute_path(path_, name), fault);
  }
  template <class T>
  void require_range(const std::string& attribute, T value, T min, T max) const {
    require_attribute(value >= min && value <= max, attribute,
                      fmt::format("expected {} to {}, found {}", min, max, value));
  }
  void require_positive(const std::string& attribute, double value, double max) const {
    require_attribute(value > 0.0 && value <= max, attribute,
                      fmt::format("expected more than 0 and at most {}, found {}", max, value));
  }
  void require_rate(double rate_hz) const { require_positive("rate_hz", rate_hz, max_rate_hz); }
  template <class Values>
  void require_finite(const std::string& dataset, const Values& values) const {
    const auto bad = std::ranges::find_if_not(values, [](auto v) { return std::isfinite(v); });
    if (bad != std::ranges::end(values))
      require(false, dataset,
              fmt::format("expected finite values, found {} at index {}", *bad,
                          bad - std::ranges::begin(values)));
  }
  template <class T>
  void require_increasing(const std::string& dataset, const std::vector<T>& values) const {
    const auto bad = std::adjacent_find(values.begin(), values.end(), std::greater_equal<>());
    if (bad != values.end())
      require(false, dataset,
              fmt::format("expected strictly increasing values, found {} after {} at index {}",
                          *(bad + 1), *bad, bad - values.begin() + 1));
  }
  void require_times(const std::string& dataset, const std::vector<double>& times_s) const {
    require_finite(dataset, times_s);
    const auto bad = std::ranges::is_sorted_until(times_s);
    if (bad != times_s.end())
      require(false, dataset,
              fmt::format("expected times that do not run backward, found {} after {} at index {}",
                          *bad, *(bad - 1), bad - times_s.begin()));
  }
  void require_counter(const std::string& dataset, const std::vector<std::uint64_t>& values) const {
    require_increasing(dataset, values);
    require(values.empty() || values.back() - values.front() <= max_counted_frames, dataset,
            fmt::format("expected at most {} frames with the lost ones, found {} to {}",
                        max_counted_frames, values.empty() ? 0 : values.front(),
                        values.empty() ? 0 : values.back()));
  }
  void require_clip_indices(const std::vector<std::int32_t>& clip, std::size_t num_clips) const {
    require(std::is_sorted(clip.begin(), clip.end()), "clip",
            "expected indices in increasing order");
    if (faults_.contains("/clips")) return;
    for (const std::int32_t i : clip)
      if (i < 0 || static_cast<std::size_t>(i) >= num_clips)
        return require(
            false, "clip",
            fmt::format("expected 0 to {}, found {}", static_cast<std::int64_t>(num_clips) - 1, i));
  }

 private:
  FileFaults& faults_;
  std::string path_;
};

void validate_clips(const std::vector<Clip>& clips, FileFaults& faults) {
  double last_end_s = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const auto& [start_s, end_s, object, fell, hand_box, object_box, box_frame] = clips[i];
    const std::string path = fmt::format("/clips, clip {}", i);
    faults.require(std::isfinite(start_s) && std::isfinite(end_s) && start_s < end_s, path,
                   fmt::format("expected start_s < end_s, found {} and {}", start_s, end_s));
    faults.require(!(std::abs(start_s) > max_clip_time_s || std::abs(end_s) > max_clip_time_s),
                   path,
                   fmt::format("expected times of the streams' clock, within {} s, found {} to {}",
                               max_clip_time_s, start_s, end_s));
    faults.require(
        !(start_s < last_end_s), path,
        fmt::format("starts at {} s, before the previous clip ends at {} s", start_s, last_end_s));
    last_end_s = end_s;
  }
}

void validate_inertial(const InertialStream& unit, const Validator& group) {
  group.require_rate(unit.rate_hz);
  group.require_finite("place", unit.position_m);
  group.require_finite("specific_force", unit.specific_force_m_per_s2);
  group.require_finite("angular_velocity", unit.angular_velocity_rad_per_s);
  group.require_finite("orientation_wxyz", unit.orientation_wxyz);
  group.require_counter("sequence", unit.sequence);
  group.require_times("host_time_s", unit.host_time_s);
}

void validate_glove_info(const GloveInfo& info, const Validator& group) {
  group.require_range("rows", info.rows, 1, max_rows);
  group.require_range("cols", info.cols, 1, max_rows);
  group.require_rate(info.rate_hz);
  group.require_range("scan_s", info.scan_s, 0.0, 1.0);
  group.require_range("bits", info.bits, 1, 16);
  group.require_attribute(info.polarity == 1 || info.polarity == -1, "polarity",
                          fmt::format("expected 1 or -1, found {}", info.polarity));
  group.require_finite("baseline", info.baseline_counts);
  const auto other = std::ranges::find_if(info.mask, [](auto m) { return m > 1; });
  if (other != info.mask.end())
    group.require(false, "mask", fmt::format("expected 0 and 1, found {}", *other));
  group.require(std::ranges::find(info.mask, 1) != info.mask.end(), "mask",
                "expected a taxel (1), found none");
}

void validate_glove(const GloveStream& glove, const Validator& group) {
  validate_glove_info(glove.info, group);
  if (glove.info.bits >= 1 && glove.info.bits <= 16 && !glove.counts.empty()) {
    const unsigned max_count = (1u << glove.info.bits) - 1u;
    const unsigned found = *std::ranges::max_element(glove.counts);
    group.require(
        found <= max_count, "counts",
        fmt::format("expected at most {} ({} bits), found {}", max_count, glove.info.bits, found));
  }
  group.require_counter("sequence", glove.sequence);
  group.require_times("host_time_s", glove.host_time_s);
  if (glove.inertial) validate_inertial(*glove.inertial, group.group("inertial"));
}

void validate_camera(const CameraInfo& camera, const Validator& color, const Validator& depth) {
  color.require_range("width", camera.width, 0, max_image_size);
  color.require_range("height", camera.height, 0, max_image_size);
  depth.require_range("width", camera.depth_image_width(), 0, max_image_size);
  depth.require_range("height", camera.depth_image_height(), 0, max_image_size);
  depth.require_rate(camera.rate_hz);
  depth.require_positive("depth_unit_m", camera.depth_unit_m, 1.0);
}

void validate_board(const BoardInfo& board, const Validator& group) {
  group.require_range("columns", board.columns, 2, 1000);
  group.require_range("rows", board.rows, 2, 1000);
  group.require_positive("square_m", board.square_m, 10.0);
}

void validate_true_body(const Truth::Body& body, const Validator& group) {
  group.require_finite("position_m", body.position_m);
  group.require_finite("velocity_m_per_s", body.velocity_m_per_s);
  group.require_finite("orientation_wxyz", body.orientation_wxyz);
}

/// Requires `size` numbers per label, finite unless the label is lost or outside the measured time.
void validate_states(const std::vector<double>& values, std::size_t size,
                     const std::vector<std::uint8_t>& quality, const Validator& group,
                     const std::string& dataset) {
  if (values.size() != size * quality.size())
    return group.require(false, dataset,
                         fmt::format("expected {} values, {} per label, found {}",
                                     size * quality.size(), size, values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) && (quality[i / size] & (quality_lost | quality_gap)) == 0)
      return group.require(false, dataset,
                           fmt::format("expected finite values where quality is neither lost nor "
                                       "gap, found {} for label {}",
                                       values[i], i / size));
}

void validate_labelled_body(const LabelledBody& body, const Validator& group) {
  if (group.has_fault("quality")) return;
  validate_states(body.position_m, 3, body.quality, group, "position_m");
  validate_states(body.velocity_m_per_s, 3, body.quality, group, "velocity_m_per_s");
  validate_states(body.covariance, 36, body.quality, group, "covariance");
  validate_states(body.causal_position_m, 3, body.quality, group, "causal_position_m");
  validate_states(body.causal_velocity_m_per_s, 3, body.quality, group, "causal_velocity_m_per_s");
}

}  // namespace

void validate(const CameraTimes& times, const std::string& path, FileFaults& faults) {
  const Validator group(faults, path);
  group.require_counter("sequence", times.sequence);
  group.require_times("device_time_s", times.device_time_s);
  group.require_times("host_time_s", times.host_time_s);
}

void validate(const Recording& recording, const std::string& color, const std::string& depth,
              FileFaults& faults) {
  validate_clips(recording.clips, faults);
  validate_camera(recording.camera, {faults, color}, {faults, depth});
  validate_board(recording.board, {faults, "/board"});
  for (std::size_t i = 0; i < recording.gloves.size(); ++i)
    validate_glove(recording.gloves[i], {faults, "/" + glove_group(i)});
}

void validate(const Truth& truth, FileFaults& faults) {
  const Validator group(faults, "/truth");
  group.require_times("time_s", truth.time_s);
  group.require_clip_indices(truth.clip, std::numeric_limits<std::int32_t>::max());
  validate_true_body(truth.hand, group.group("hand"));
  validate_true_body(truth.object, group.group("object"));
  group.require_finite("contact_force_n", truth.contact_force_n);
}

void validate(const Labels& labels, FileFaults& faults) {
  validate_clips(labels.clips, faults);
  const Validator label(faults, "/label"), raw(faults, "/raw");
  label.require_times("time_s", labels.time_s);
  label.require_clip_indices(labels.clip, labels.clips.size());
  if (!labels.glove_frame.empty()) {
    const std::int64_t least = *std::ranges::min_element(labels.glove_frame);
    label.require(least >= -1, "glove_frame",
                  fmt::format("expected -1 or a frame index, found {}", least));
  }
  validate_labelled_body(labels.hand, {faults, "/hand"});
  validate_labelled_body(labels.object, {faults, "/object"});
  raw.require_times("time_s", labels.raw.time_s);
  raw.require_clip_indices(labels.raw.clip, labels.clips.size());
  const auto& jpeg = labels.contact_sheet_jpeg;
  faults.require(jpeg.empty() || (jpeg.size() > 1 && jpeg[0] == 0xff && jpeg[1] == 0xd8),
                 "/contact_sheet_jpeg", "expected a JPEG image, which begins with bytes ff d8");
}

}  // namespace touchtrace
