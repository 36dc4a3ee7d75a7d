#include "pipeline/recording/validate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

constexpr int most_taxels_a_side = 4096;
constexpr int most_pixels_a_side = 16384;

[[noreturn]] void reject(const std::string& name, const std::string& fault) {
  throw data_error(fmt::format("{}: {}", name, fault),
                   "mend the program that wrote it, or record it again");
}

void require(bool holds, const std::string& name, const std::string& fault) {
  if (!holds) reject(name, fault);
}

template <class T>
void require_finite(std::span<const T> values, const std::string& name) {
  const auto bad =
      std::find_if(values.begin(), values.end(), [](T v) { return !std::isfinite(v); });
  require(bad == values.end(), name, fmt::format("value {} is not finite", bad - values.begin()));
}

void require_finite(const std::vector<double>& values, const std::string& name) {
  require_finite(std::span<const double>(values), name);
}

/// Where `values` do not grow.
template <class T>
void require_increasing(const std::vector<T>& values, const std::string& name) {
  const auto bad = std::adjacent_find(values.begin(), values.end(), std::greater_equal<>());
  if (bad == values.end()) return;
  reject(name, fmt::format("{} at {} does not come after {}", *(bad + 1), bad - values.begin() + 1,
                           *bad));
}

void require_times(const std::vector<double>& times_s, const std::string& name) {
  require_finite(times_s, name);
  require_increasing(times_s, name);
}

void require_clip_numbers(const std::vector<std::int32_t>& clip, std::size_t clips,
                          const std::string& name) {
  require(std::is_sorted(clip.begin(), clip.end()), name, "clips are not in order");
  require(clip.empty() || (clip.front() >= 0 && static_cast<std::size_t>(clip.back()) < clips),
          name, "a clip number is out of range");
}

void validate_clips(const std::vector<Clip>& clips, const std::string& name) {
  double last_end_s = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const Clip& clip = clips[i];
    require(std::isfinite(clip.start_s) && std::isfinite(clip.end_s) && clip.start_s < clip.end_s,
            name, fmt::format("clip {} does not end after it starts", i));
    require(clip.start_s >= last_end_s, name,
            fmt::format("clip {} starts before the one before it ends", i));
    last_end_s = clip.end_s;
  }
}

void validate_inertial(const InertialStream& unit, const std::string& name) {
  require(unit.rate_hz > 0.0 && unit.rate_hz <= 1e5, name,
          fmt::format("a rate of {} Hz", unit.rate_hz));
  require_finite(std::span<const double>(unit.place_m), name + "/place");
  require_finite(std::span<const float>(unit.specific_force_m_per_s2), name + "/specific_force");
  require_finite(std::span<const float>(unit.angular_velocity_rad_per_s),
                 name + "/angular_velocity");
  require_finite(std::span<const float>(unit.orientation_wxyz), name + "/orientation_wxyz");
  require_increasing(unit.sequence, name + "/sequence");
  require_times(unit.host_time_s, name + "/host_time_s");
}

void validate_glove(const GloveStream& glove, const std::string& name) {
  const GloveInfo& info = glove.info;
  require(info.rows > 0 && info.rows <= most_taxels_a_side && info.cols > 0 &&
              info.cols <= most_taxels_a_side,
          name, fmt::format("{} rows and {} columns of taxels", info.rows, info.cols));
  require(info.rate_hz > 0.0 && info.rate_hz <= 1e5, name,
          fmt::format("a rate of {} Hz", info.rate_hz));
  require(info.scan_s >= 0.0 && info.scan_s <= 1.0, name,
          fmt::format("a scan of {} s", info.scan_s));
  require(info.bits >= 1 && info.bits <= 16, name,
          fmt::format("a converter of {} bits", info.bits));
  require(info.polarity == 1 || info.polarity == -1, name,
          fmt::format("polarity {}", info.polarity));
  require_finite(std::span<const float>(info.baseline_counts), name + "/baseline");
  require(std::any_of(info.mask.begin(), info.mask.end(), [](auto m) { return m == 1; }), name,
          "the mask leaves no taxel");
  require(std::all_of(info.mask.begin(), info.mask.end(), [](auto m) { return m <= 1; }), name,
          "the mask holds other values than 0 and 1");
  const auto top = (1u << info.bits) - 1u;
  require(std::all_of(glove.counts.begin(), glove.counts.end(), [&](auto c) { return c <= top; }),
          name, fmt::format("counts beyond the converter's {} bits", info.bits));
  require_increasing(glove.sequence, name + "/sequence");
  require_times(glove.host_time_s, name + "/host_time_s");
  if (glove.inertial) validate_inertial(*glove.inertial, name + "/inertial");
}

void validate_camera(const Recording& recording, const std::string& name) {
  const CameraInfo& camera = recording.camera;
  require(camera.width >= 0 && camera.width <= most_pixels_a_side && camera.height >= 0 &&
              camera.height <= most_pixels_a_side,
          name, fmt::format("images of {} x {}", camera.width, camera.height));
  require(camera.rate_hz > 0.0 && camera.rate_hz <= 1e5, name,
          fmt::format("a rate of {} Hz", camera.rate_hz));
  require(camera.depth_unit_m > 0.0 && camera.depth_unit_m <= 1.0, name,
          fmt::format("a depth unit of {} m", camera.depth_unit_m));
  require_finite(std::span<const double>(camera.gravity), name + "/gravity");
  require_finite(std::span<const double>(camera.depth_intrinsics), name + "/depth_intrinsics");
  require_increasing(recording.camera_times.sequence, name + "/sequence");
  require_times(recording.camera_times.device_time_s, name + "/device_time_s");
  require_times(recording.camera_times.host_time_s, name + "/host_time_s");
}

void validate_body(const Truth::Body& body, const std::string& name) {
  require_finite(body.position_m, name + "/position_m");
  require_finite(body.velocity_m_per_s, name + "/velocity_m_per_s");
  require_finite(body.orientation_wxyz, name + "/orientation_wxyz");
}

/// `values` hold `size` numbers a label; a label that is lost may hold none.
void require_finite_where_known(const std::vector<double>& values, std::size_t size,
                                const std::vector<std::uint8_t>& quality, const std::string& name) {
  require(values.size() == size * quality.size(), name, "it has not a value for every label");
  for (std::size_t i = 0; i < quality.size(); ++i)
    if ((quality[i] & (quality_lost | quality_gap)) == 0)
      require_finite(std::span(values).subspan(size * i, size), fmt::format("{} at {}", name, i));
}

void validate_body(const LabelledBody& body, const std::string& name) {
  const auto check = [&](const std::vector<double>& values, std::size_t size, const char* part) {
    require_finite_where_known(values, size, body.quality, name + part);
  };
  check(body.position_m, 3, "/position_m");
  check(body.velocity_m_per_s, 3, "/velocity_m_per_s");
  check(body.covariance, 36, "/covariance");
  check(body.causal_position_m, 3, "/causal_position_m");
  check(body.causal_velocity_m_per_s, 3, "/causal_velocity_m_per_s");
}

}  // namespace

void validate(const Recording& recording, const std::string& name) {
  require(!recording.activity.empty(), name, "the activity has no name");
  validate_clips(recording.clips, name + ":/clips");
  validate_camera(recording, name + ":/camera");
  const BoardInfo& board = recording.board;
  require(board.columns >= 2 && board.columns <= 1000 && board.rows >= 2 && board.rows <= 1000 &&
              board.square_m > 0.0 && board.square_m <= 10.0,
          name + ":/board", "there is no such chessboard");
  for (std::size_t i = 0; i < recording.gloves.size(); ++i)
    validate_glove(recording.gloves[i], fmt::format("{}:/glove{}", name, i));
}

void validate(const Truth& truth, const std::string& name) {
  require_times(truth.time_s, name + ":/truth/time_s");
  require_clip_numbers(truth.clip, std::numeric_limits<std::int32_t>::max(), name + ":/truth/clip");
  validate_body(truth.hand, name + ":/truth/hand");
  validate_body(truth.object, name + ":/truth/object");
  require_finite(truth.contact_force_n, name + ":/truth/contact_force_n");
}

void validate(const Labels& labels, const std::string& name) {
  require(!labels.activity.empty(), name, "the activity has no name");
  validate_clips(labels.clips, name + ":/clips");
  require_times(labels.time_s, name + ":/label/time_s");
  require_clip_numbers(labels.clip, labels.clips.size(), name + ":/label/clip");
  require(std::all_of(labels.glove_frame.begin(), labels.glove_frame.end(),
                      [](auto f) { return f >= -1; }),
          name + ":/label/glove_frame", "a frame number is below -1");
  validate_body(labels.hand, name + ":/hand");
  validate_body(labels.object, name + ":/object");
  require_times(labels.raw.time_s, name + ":/raw/time_s");
  require_clip_numbers(labels.raw.clip, labels.clips.size(), name + ":/raw/clip");
}

}  // namespace touchtrace
