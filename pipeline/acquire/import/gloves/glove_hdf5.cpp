#include <fmt/ranges.h>

#include <algorithm>
#include <climits>
#include <cmath>

#include "engine/base/progress.h"
#include "pipeline/acquire/import/formats/byte_reader.h"
#include "pipeline/acquire/import/gloves/glove_file.h"
#include "pipeline/recording/h5_file.h"

namespace touchtrace {
namespace {

using h5::unknown_length;

constexpr h5::DatasetInfo no_unit{"1", ""};
constexpr double min_unix_s = 1e8;  ///< 1973
const h5::Axis any_length{"any", unknown_length};

void set_layout(GloveFile& glove, const std::vector<hsize_t>& shape, const std::string& path) {
  if (shape.size() != 3 || shape[1] > INT_MAX || shape[2] > INT_MAX)
    throw h5::H5Error(fmt::format("{}: expected an array [frames, rows, cols]", path));
  glove.rows = static_cast<int>(shape[1]), glove.cols = static_cast<int>(shape[2]);
}

void read_frames(const h5::Loader& group, const std::string& times, const std::string& values,
                 GloveFile& glove) {
  std::vector<h5::Axis> time_axes{any_length};
  if (group.shape(times).size() == 2) time_axes.push_back({"time", 1});
  group.padded_array(times, glove.time_s, time_axes, no_unit);
  group.padded_array(values, glove.values, {any_length, any_length, any_length}, no_unit);
}

/// Tells rows that were never written by their time of 0 or NaN. They pad the end, stand for frames
/// that were shown but not recorded, or are the first row of early writers of MIT's gloves. Times
/// that are not since 1970 may begin at 0.
class WrittenRows {
 public:
  explicit WrittenRows(const std::vector<double>& time_s) : time_s_(time_s), end_(time_s.size()) {
    is_since_1970_ = std::ranges::any_of(time_s, [](double stamp) { return stamp > min_unix_s; });
    while (end_ > 0 && !(time_s[end_ - 1] > 0.0 || time_s[end_ - 1] < 0.0)) --end_;
  }
  bool operator[](std::size_t row) const {
    return row < end_ && (is_since_1970_ ? time_s_[row] > 0.0 : !std::isnan(time_s_[row]));
  }
  /// End of the rows before the padding.
  std::size_t end() const { return end_; }

 private:
  const std::vector<double>& time_s_;
  std::size_t end_;
  bool is_since_1970_;
};

/// Drops rows that were never written.
void drop_unwritten(GloveFile& glove) {
  const std::size_t taxels = glove.taxels(), num_values = glove.values.size() / taxels,
                    rows = std::min(glove.time_s.size(), num_values);
  if (num_values != glove.time_s.size())
    Progress::warn(fmt::format("glove: {} frames have {} times; the rest is skipped", num_values,
                               glove.time_s.size()));
  const std::vector<double> time_s = glove.time_s;
  const WrittenRows is_written(time_s);
  std::size_t frames = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    if (!is_written[row]) continue;
    glove.time_s[frames] = glove.time_s[row];
    std::copy_n(&glove.values[row * taxels], taxels, &glove.values[frames * taxels]);
    ++frames;
  }
  if (const std::size_t known = std::min(is_written.end(), rows); frames < known)
    Progress::report(
        fmt::format("glove: skipped {} of {} rows, which have no time", known - frames, known));
  glove.time_s.resize(frames);
  glove.values.resize(frames * taxels);
}

/// WiReSens toolkit (Sensor.py of WiReSensPy). `frame_count` is the index of the last frame or the
/// number of frames, depending on the writer: it is not used.
void read_wiresens(const h5::Loader& root, const GloveFileOptions& options, GloveFile& glove) {
  require_no_stream(options);
  set_layout(glove, root.shape("pressure"), root.path("pressure"));
  read_frames(root, "ts", "pressure", glove);
}

/// Name of the only glove, or the one that the user chose.
std::string chosen_device(const std::vector<std::string>& devices, const std::string& stream) {
  const bool is_known = std::ranges::find(devices, stream) != devices.end();
  if (stream.empty() ? devices.size() == 1 : is_known) return stream.empty() ? devices[0] : stream;
  throw data_error(stream.empty() ? fmt::format("the file has {} gloves", devices.size())
                                  : fmt::format("the file has no glove '{}'", stream),
                   fmt::format("give --glove-stream: {}", fmt::join(devices, " or ")));
}

/// ActionSense (DataLogger.py of ActionNet): a group per device and stream, times [frames, 1].
void read_actionsense(const h5::Loader& root, const std::vector<std::string>& devices,
                      const std::string& stream, GloveFile& glove) {
  const h5::Loader group = root.group(chosen_device(devices, stream)).group("tactile_data");
  set_layout(glove, group.shape("data"), group.path("data"));
  read_frames(group, "time_s", "data", glove);
}

GloveFile read_glove(const h5::Loader& root, const GloveFileOptions& options) {
  GloveFile glove;
  std::vector<std::string> devices;
  for (const char* name : {"tactile-glove-left", "tactile-glove-right"})
    if (root.has(name)) devices.emplace_back(name);
  if (!devices.empty())
    read_actionsense(root, devices, options.stream, glove);
  else if (root.has("pressure") && root.has("ts"))
    read_wiresens(root, options, glove);
  else
    throw h5::H5Error(
        "expected /pressure and /ts (WiReSens), or /tactile-glove-left/tactile_data (ActionSense)");
  if (glove.taxels() > 0) drop_unwritten(glove);
  return glove;
}

}  // namespace

bool is_glove_hdf5(const std::filesystem::path& file) {
  return begins_with(file, "\x89HDF\r\n\x1a\n");
}

GloveFile read_glove_hdf5(const std::filesystem::path& file, const GloveFileOptions& options) {
  return h5::read_untrusted(
      file, [&](FileFaults& faults) { return read_glove(h5::open_root(file, faults), options); });
}

}  // namespace touchtrace
