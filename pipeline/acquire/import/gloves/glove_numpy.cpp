#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/import/gloves/glove_arrays.h"

namespace touchtrace {
namespace {

using Names = std::vector<std::string>;
using Arrays = std::map<std::string, NumpyArray>;

const Names time_names{"time_s",    "host_time_s", "times", "timestamps",
                       "timestamp", "time",        "ts",    "t"};
const Names value_names{"counts", "pressure", "tactile_data", "tactile", "data", "values"};

constexpr const char* sequence_name = "sequence";
constexpr const char* epoch_name = "epoch_unix_s";
constexpr double max_number = 9e15;
constexpr std::size_t max_taxel_lines = 128;  // rows or columns of a glove

/// First of `names` that exists.
const NumpyArray& find_array(const Arrays& arrays, const Names& names,
                             const std::filesystem::path& file) {
  for (const auto& name : names)
    if (const auto found = arrays.find(name); found != arrays.end()) return found->second;
  throw data_error(fmt::format("{} has no array {}", file.string(), names[0]),
                   fmt::format("it may have one of the names {}{}", fmt::join(names, ", "),
                               names == time_names ? "; or give --rate HZ" : ""));
}

void require_archive(const std::filesystem::path& file) {
  if (file.extension() == ".npz") return;
  throw data_error(
      fmt::format("{} is a single array: it has no times", file.string()),
      fmt::format("join them in Python: numpy.savez('glove.npz', counts=numpy.load('{}'), "
                  "time_s=...)",
                  file.filename().string()));
}

/// Times of an array, or those of the rate.
void set_times(GloveFile& glove, const Arrays& arrays, const NumpyArray& values, double rate_hz,
               const std::filesystem::path& file) {
  const bool has_times = std::ranges::any_of(
      time_names, [&](const std::string& name) { return arrays.contains(name); });
  if (!has_times && rate_hz > 0.0 && !values.shape.empty()) {
    for (std::size_t i = 0; i < values.shape[0]; ++i)
      glove.time_s.push_back(static_cast<double>(i) / rate_hz);
    glove.has_time_unit = true, glove.counted_rate_hz = rate_hz;
    return;
  }
  const NumpyArray& times = find_array(arrays, time_names, file);
  for (std::size_t i = 0; i < times.size(); ++i) glove.time_s.push_back(times.at(i));
  glove.has_time_unit =
      times.per_second > 0.0 || arrays.contains("time_s") || arrays.contains("host_time_s");
}

void require_shape(std::size_t num_times, const NumpyArray& values) {
  const std::size_t axes = values.shape.size();
  if ((axes != 2 && axes != 3) || values.size() == 0 || values.shape[0] != num_times)
    throw data_error(fmt::format("the arrays of the glove have {} times and {} frames of {} axes",
                                 num_times, axes > 0 ? values.shape[0] : 0, axes),
                     "times are [frames], counts are [frames, rows, cols] or [frames, taxels]");
}

/// Axis that counts the frames of an array with three axes: with the layout given, the one whose
/// other axes are rows and columns; else the first one. Throws data_error if another one is longer
/// than a glove's rows or columns.
std::size_t frame_axis(const std::vector<std::size_t>& shape, const GloveFileOptions& options) {
  const std::pair layout(static_cast<std::size_t>(options.rows),
                         static_cast<std::size_t>(options.cols));
  for (std::size_t axis = 0; axis < shape.size(); ++axis)
    if (std::pair(shape[axis == 0 ? 1 : 0], shape[axis == 2 ? 1 : 2]) == layout) return axis;
  const std::size_t longest = std::ranges::max(shape);
  if (options.rows + options.cols == 0 && longest > max_taxel_lines && longest != shape[0])
    throw data_error(fmt::format("the array has {} values: the first axis should count frames",
                                 fmt::join(shape, " x ")),
                     "give --rows and --cols, then the third axis is that of the frames");
  return 0;
}

/// The array with frames along the first axis; nullopt if they are there already.
std::optional<NumpyArray> frames_first(const NumpyArray& array, const GloveFileOptions& options) {
  if (array.shape.size() != 3) return std::nullopt;
  const std::size_t axis = frame_axis(array.shape, options);
  if (axis == 0) return std::nullopt;
  Progress::report(fmt::format("glove: axis {} of {} values counts the frames", axis + 1,
                               fmt::join(array.shape, " x ")));
  return moved_to_front(array, axis);
}

/// Options with the shape of an array of frames. Throws data_error if they contradict it.
GloveFileOptions layout_of(const NumpyArray& values, GloveFileOptions options) {
  if (values.shape.size() != 3) return options;
  const auto rows = static_cast<int>(values.shape[1]), cols = static_cast<int>(values.shape[2]);
  if ((options.rows > 0 && options.rows != rows) || (options.cols > 0 && options.cols != cols))
    throw data_error(fmt::format("the array has {} x {} taxels, not {} x {}", rows, cols,
                                 options.rows, options.cols),
                     "leave out --rows and --cols");
  options.rows = rows, options.cols = cols;
  return options;
}

/// Frame numbers; empty if the array has another length.
std::vector<std::uint64_t> sequence_of(const NumpyArray& array, std::size_t frames) {
  std::vector<std::uint64_t> sequence;
  if (array.size() != frames) return sequence;
  for (std::size_t i = 0; i < frames; ++i) {
    const double number = array.at(i);
    const bool is_number = number >= 0.0 && number <= max_number;
    sequence.push_back(is_number ? static_cast<std::uint64_t>(number) : 0);
  }
  return sequence;
}

}  // namespace

bool is_glove_numpy(const std::filesystem::path& file) { return is_numpy_file(file); }

const std::vector<std::string>& glove_array_names() {
  static const Names names = [] {
    Names all = time_names;
    all.insert(all.end(), {sequence_name, epoch_name});
    all.insert(all.end(), value_names.begin(), value_names.end());
    return all;
  }();
  return names;
}

GloveFile glove_of_arrays(const std::map<std::string, NumpyArray>& arrays,
                          const std::filesystem::path& file, const GloveFileOptions& options) {
  const NumpyArray& stored = find_array(arrays, value_names, file);
  if (stored.size() == 0)  // other axes may then have any length
    throw data_error(file.string() + " has no frames", "record again");
  const auto moved = frames_first(stored, options);
  const NumpyArray& values = moved ? *moved : stored;
  GloveFile glove;
  set_times(glove, arrays, values, options.rate_hz, file);
  const std::size_t frames = glove.time_s.size();
  require_shape(frames, values);
  set_layout(glove, values.size() / frames, layout_of(values, options));
  if (const auto numbers = arrays.find(sequence_name); numbers != arrays.end())
    glove.sequence = sequence_of(numbers->second, frames);
  if (const auto epoch = arrays.find(epoch_name); epoch != arrays.end() && epoch->second.size() > 0)
    glove.epoch_unix_s = epoch->second.at(0);
  for (std::size_t i = 0; i < values.size(); ++i)
    glove.values.push_back(static_cast<float>(values.at(i)));
  return glove;
}

GloveFile read_glove_numpy(const std::filesystem::path& file, const GloveFileOptions& options) {
  require_archive(file);
  require_no_stream(options);
  return glove_of_arrays(read_numpy_archive(file, glove_array_names()), file, options);
}

}  // namespace touchtrace
