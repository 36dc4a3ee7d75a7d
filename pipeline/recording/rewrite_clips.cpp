#include <algorithm>
#include <set>

#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "pipeline/recording/h5_file.h"
#include "pipeline/recording/mask_file.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/recording/recording_layout.h"
#include "pipeline/recording/recording_schema.h"

namespace touchtrace {
namespace {

using Masks = std::map<std::size_t, std::vector<std::uint8_t>>;

/// New mask of a colour image, or else the stored one.
std::vector<std::uint8_t> mask_of(std::size_t color_image, const RecordingReader& reader,
                                  const Masks& masks) {
  const auto found = masks.find(color_image);
  return found != masks.end() ? found->second : reader.read_mask(color_image);
}

void write_masks(h5::Saver& root, const RecordingReader& reader, const Masks& masks) {
  const auto stored = reader.masked_color_images();
  std::set<std::size_t> images(stored.begin(), stored.end());
  for (const auto& [image, mask] : masks) images.insert(image);
  if (images.empty()) return;
  MaskWriter writer(root.group("masks"), reader.recording().camera);
  for (std::size_t image : images) writer.append(image, mask_of(image, reader, masks));
  writer.finish();
}

void remove_group(hid_t file, const char* name) {
  if (H5Lexists(file, name, H5P_DEFAULT) > 0) h5::check(H5Ldelete(file, name, H5P_DEFAULT), name);
}

void replace_groups(const std::filesystem::path& path, const RecordingReader& reader,
                    const std::vector<Clip>& clips, const Masks& masks) {
  h5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, path.string());
  remove_group(file, "clips");
  remove_group(file, "masks");
  {
    h5::Saver root(h5::Handle(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "cannot open the file"));
    h5::Saver group = root.group("clips");
    const ClipColumns columns = to_columns(clips);
    serialize_clips(group, columns);
    write_masks(root, reader, masks);
  }
  h5::close_file(file);
}

/// Writes a recording of schema 1, whose colour and depth images are pairs, in today's schema.
void upgrade(const std::filesystem::path& from, const std::filesystem::path& to,
             const RecordingReader& reader, const std::vector<Clip>& clips, const Masks& masks,
             bool overwrite) {
  Recording recording = reader.recording();
  recording.clips = clips;
  const std::size_t frames = recording.camera_times.frames();
  Progress progress("copying images", frames);
  RecordingWriter writer(to, recording.camera, overwrite);
  for (std::size_t i = 0; i < frames; ++i, progress.advance()) {
    RgbdFrame frame = reader.read_camera_frame(i);
    frame.mask = mask_of(i, reader, masks);
    writer.append_camera_frame(frame);
  }
  for (std::size_t i = 0; i < reader.background_frames(); ++i)
    writer.append_background(reader.read_background(i));
  for (std::size_t i = 0; i < reader.board_views(); ++i)
    writer.append_board_view(reader.read_board_view(i));
  if (reader.has_truth()) writer.write_truth(read_truth(from));
  writer.finish(recording);
}

/// Adds the shift of RecordingReader to the times of `clips`.
std::vector<Clip> on_file_clock(std::vector<Clip> clips, double shift_s) {
  for (auto& clip : clips) clip.start_s += shift_s, clip.end_s += shift_s;
  return clips;
}

}  // namespace

void rewrite_clips(const std::filesystem::path& from, const std::filesystem::path& to,
                   const std::vector<Clip>& clips, const Masks& masks, bool overwrite) {
  RecordingReader::validate(from);
  const RecordingReader reader(from);
  if (h5::schema_of(from) == recording_schema_1)
    return upgrade(from, to, reader, clips, masks, overwrite);
  std::error_code none;
  OutputFile output(to, overwrite || std::filesystem::equivalent(from, to, none));
  std::filesystem::copy_file(from, output.temporary(),
                             std::filesystem::copy_options::overwrite_existing);
  std::filesystem::permissions(output.temporary(), std::filesystem::perms::owner_write,
                               std::filesystem::perm_options::add);
  h5::write_checked(to, [&] {
    replace_groups(output.temporary(), reader, on_file_clock(clips, reader.clock_shift_s()), masks);
  });
  output.commit();
}

}  // namespace touchtrace
