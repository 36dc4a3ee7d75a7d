#include "pipeline/study/sessions.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/study/label_error.h"
#include "pipeline/study/truth.h"

namespace touchtrace::study {
namespace {

namespace fs = std::filesystem;

/// By its name, which `label` gives by default.
bool is_labels_file(const fs::path& file) {
  return file.filename() == "labels.h5" || file.filename().string().ends_with(".labels.h5");
}

/// Recordings in a folder, which are all .h5 files that are not labels.
std::vector<fs::path> recordings_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".h5" && !is_labels_file(entry.path()))
      files.push_back(entry.path());
  if (files.empty())
    throw usage_error(fmt::format("folder {} has no recording (.h5)", folder.string()),
                      "give recordings, or the folder in which they are");
  std::ranges::sort(files);
  return files;
}

std::vector<fs::path> recording_files(const std::vector<std::string>& files_or_folders) {
  std::vector<fs::path> files;
  for (const fs::path path : files_or_folders)
    if (fs::is_directory(path))
      std::ranges::copy(recordings_in(path), std::back_inserter(files));
    else
      files.push_back(path);
  return files;
}

void add_truth(Session& session, const LabelledRecording& source) {
  attach_truth(session.data, {source});
  shift_truth(session.data, estimate_truth_offset(session.data));
  session.label_error =
      compare_labels_with_truth(read_labels(source.labels), read_truth(source.recording));
}

}  // namespace

std::vector<LabelledRecording> pair_files(const std::vector<std::string>& recordings,
                                          const std::vector<std::string>& labels) {
  const auto files = recording_files(recordings);
  if (!labels.empty() && files.size() != labels.size())
    throw usage_error(
        fmt::format("{} recordings but {} label files", files.size(), labels.size()),
        "give one --labels file per --recording, in the same order, or none if the labels of "
        "wave.h5 are wave.labels.h5");
  std::vector<LabelledRecording> sources;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!fs::exists(files[i]))
      throw data_error(fmt::format("{} does not exist", files[i].string()), "check --recording");
    if (is_labels_file(files[i]))
      throw data_error(
          fmt::format("{} has labels; --recording takes recordings", files[i].string()),
          "give the recording; its labels are found by its name or given by --labels");
    sources.push_back({files[i], labels.empty() ? labels_path_of(files[i]) : fs::path(labels[i])});
    if (labels.empty() && !fs::exists(sources.back().labels))
      throw data_error(
          fmt::format("labels of {} are missing: {} does not exist", files[i].string(),
                      sources.back().labels.string()),
          "make them with `touchtrace label` or scripts/write_labels.py, or give them with "
          "--labels");
  }
  return sources;
}

std::vector<Session> load_sessions(const std::vector<LabelledRecording>& sources,
                                   const std::string& against) {
  std::vector<Session> sessions;
  for (const LabelledRecording& source : sources) {
    Session session{source.recording.filename().string(), load_dataset({source}), {}};
    if (against != "labels" && has_truth(source.recording)) add_truth(session, source);
    sessions.push_back(std::move(session));
  }
  return sessions;
}

}  // namespace touchtrace::study
