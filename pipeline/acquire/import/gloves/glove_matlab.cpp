#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/base/error.h"
#include "pipeline/acquire/import/formats/matlab_file.h"
#include "pipeline/acquire/import/gloves/glove_arrays.h"

namespace touchtrace {
namespace {

using Arrays = std::map<std::string, NumpyArray>;

constexpr const char* recording_name = "recordingId";

/// Text of a recording's number.
std::string text_of(double number) { return fmt::format("{:.0f}", number); }

/// Throws data_error unless the user chose one of the recordings, or there is only one.
std::string chosen_recording(const NumpyArray& recording_of_frame, const std::string& chosen,
                             const std::filesystem::path& file) {
  std::set<double> recordings;
  for (std::size_t i = 0; i < recording_of_frame.size(); ++i)
    if (std::isfinite(recording_of_frame.at(i))) recordings.insert(recording_of_frame.at(i));
  if (recordings.empty()) throw data_error(file.string() + " has no frames", "record again");
  if (chosen.empty() && recordings.size() == 1) return text_of(*recordings.begin());
  for (const double recording : recordings)
    if (text_of(recording) == chosen) return chosen;
  throw data_error(
      chosen.empty() ? fmt::format("{} has {} recordings", file.string(), recordings.size())
                     : fmt::format("{} has no recording '{}'", file.string(), chosen),
      fmt::format("give --glove-stream with a number of its array {}, from {} to {}",
                  recording_name, text_of(*recordings.begin()), text_of(*recordings.rbegin())));
}

/// The frames with these indices, along the first axis, of an array that has an axis of `frames`.
NumpyArray select_frames(const NumpyArray& array, std::size_t frames,
                         const std::vector<std::size_t>& indices) {
  const auto axis = std::ranges::find(array.shape, frames);
  if (frames == 0 || axis == array.shape.end()) return array;
  const auto stored = moved_to_front(array, static_cast<std::size_t>(axis - array.shape.begin()));
  NumpyArray selected{stored.shape, stored.type, {}, stored.per_second};
  selected.shape[0] = indices.size();
  const std::size_t bytes = stored.data.size() / frames;
  for (const std::size_t i : indices) selected.data.append(stored.data, i * bytes, bytes);
  return selected;
}

/// Arrays of one recording.
Arrays select_recording(Arrays arrays, const std::string& chosen,
                        const std::filesystem::path& file) {
  const auto found = arrays.find(recording_name);
  if (found == arrays.end()) return arrays;
  const NumpyArray recording_of_frame = std::move(found->second);
  arrays.erase(found);
  const std::string recording = chosen_recording(recording_of_frame, chosen, file);
  const std::size_t frames = recording_of_frame.size();
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < frames; ++i)
    if (text_of(recording_of_frame.at(i)) == recording) indices.push_back(i);
  for (auto& [name, array] : arrays) array = select_frames(array, frames, indices);
  return arrays;
}

}  // namespace

bool is_glove_matlab(const std::filesystem::path& file) { return is_matlab_file(file); }

GloveFile read_glove_matlab(const std::filesystem::path& file, const GloveFileOptions& options) {
  auto names = glove_array_names();
  names.emplace_back(recording_name);
  Arrays arrays = read_matlab_arrays(file, names);
  if (!arrays.contains(recording_name)) require_no_stream(options);
  return glove_of_arrays(select_recording(std::move(arrays), options.stream, file), file, options);
}

}  // namespace touchtrace
