#include "engine/base/files.h"
#include "pipeline/recording/h5_file.h"
#include "pipeline/recording/labels_schema.h"
#include "pipeline/recording/validate.h"

namespace touchtrace {
namespace {

void save(h5::Saver root, const Labels& labels) {
  root.attribute("Conventions", std::string("CF-1.10"));
  root.attribute("schema", std::string(labels_schema));
  root.attribute("provenance", nlohmann::json(labels.provenance));
  ClipColumns clips = to_columns(labels.clips);
  clips.box_frame.clear();  // an index into the recording
  h5::Saver group = root.group("clips");
  serialize_clips(group, std::as_const(clips));
  serialize_labels(root, labels);
}

}  // namespace

void write_labels(const std::filesystem::path& path, const Labels& labels, bool overwrite) {
  FileFaults faults;
  validate(labels, faults);
  faults.throw_if_any(path);
  OutputFile output(path, overwrite);
  h5::write_checked(path, [&] {
    h5::Handle file = h5::create_file(output.temporary());
    save(h5::Saver(
             h5::Handle(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "cannot open the root group")),
         labels);
    h5::close_file(file);
  });
  output.commit();
}

std::filesystem::path labels_path_of(const std::filesystem::path& recording) {
  return std::filesystem::path(recording).replace_extension(".labels.h5");
}

Labels read_labels(const std::filesystem::path& path) {
  return h5::read_untrusted(path, [&](FileFaults& faults) {
    const h5::Loader root = h5::open_root(path, {labels_schema}, faults);
    Labels labels;
    labels.provenance = read_provenance(root);
    labels.clips = read_clips(root, std::nullopt);
    serialize_labels(root, labels);
    validate(labels, faults);
    return labels;
  });
}

}  // namespace touchtrace
