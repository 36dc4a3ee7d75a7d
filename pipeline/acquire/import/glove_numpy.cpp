#include <fmt/core.h>

#include "engine/base/error.h"
#include "pipeline/acquire/import/glove_file.h"
#include "pipeline/acquire/import/image_times.h"
#include "pipeline/acquire/import/numpy_file.h"

namespace touchtrace {
namespace {

using Names = std::vector<std::string>;

const Names time_names{"time_s", "host_time_s", "times", "timestamps", "timestamp", "ts"};
const Names value_names{"counts", "pressure", "tactile_data", "tactile", "data", "values"};

/// First of `names` that exists.
const NumpyArray& find_array(const std::map<std::string, NumpyArray>& arrays, const Names& names,
                             const std::filesystem::path& file) {
  for (const auto& name : names)
    if (const auto found = arrays.find(name); found != arrays.end()) return found->second;
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ", ") + name;
  throw data_error(fmt::format("{} has no array {}", file.string(), names[0]),
                   "it may have one of the names " + list);
}

void require_shape(const NumpyArray& times, const NumpyArray& values) {
  const std::size_t axes = values.shape.size();
  if ((axes != 2 && axes != 3) || values.size() == 0 || values.shape[0] != times.size())
    throw data_error(fmt::format("the arrays of the glove have {} times and {} frames of {} axes",
                                 times.size(), axes > 0 ? values.shape[0] : 0, axes),
                     "times are [frames], counts are [frames, rows, cols] or [frames, taxels]");
}

}  // namespace

bool is_glove_numpy(const std::filesystem::path& file) { return file.extension() == ".npz"; }

GloveFile read_glove_numpy(const std::filesystem::path& file, const GloveFileOptions& options) {
  Names wanted = time_names;
  wanted.insert(wanted.end(), value_names.begin(), value_names.end());
  const auto arrays = read_numpy_archive(file, wanted);
  const NumpyArray &times = find_array(arrays, time_names, file),
                   &values = find_array(arrays, value_names, file);
  require_shape(times, values);
  GloveFile glove;
  GloveFileOptions layout = options;
  if (values.shape.size() == 3)
    layout.rows = static_cast<int>(values.shape[1]),
    layout.cols = static_cast<int>(values.shape[2]);
  set_layout(glove, values.size() / times.size(), layout);
  for (std::size_t i = 0; i < times.size(); ++i) glove.time_s.push_back(stamp_seconds(times.at(i)));
  for (std::size_t i = 0; i < values.size(); ++i)
    glove.values.push_back(static_cast<float>(values.at(i)));
  return glove;
}

}  // namespace touchtrace
