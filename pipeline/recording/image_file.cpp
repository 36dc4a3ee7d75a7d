#include "pipeline/recording/image_file.h"

#include <fmt/core.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

h5::DatasetInfo dataset_info(ImageKind kind) {
  switch (kind) {
    case ImageKind::color:
      return {"1", "colour image, RGB"};
    case ImageKind::depth:
      return {"m", "depth = count * scale_factor; 0: no measurement"};
    default:
      return {"1", "instance of each colour pixel; 0: none"};
  }
}

h5::ElementType stored_type(ImageKind kind) {
  return kind == ImageKind::depth ? h5::element_type<std::uint16_t>()
                                  : h5::element_type<std::uint8_t>();
}

std::uint16_t depth_count(double count) {
  constexpr double max_count = std::numeric_limits<std::uint16_t>::max();
  return count > 0.0 && count <= max_count ? static_cast<std::uint16_t>(std::lround(count)) : 0;
}

}  // namespace

std::vector<hsize_t> image_shape(ImageKind kind, const CameraInfo& camera) {
  const bool is_depth = kind == ImageKind::depth;
  const int width = is_depth ? camera.depth_image_width() : camera.width,
            height = is_depth ? camera.depth_image_height() : camera.height;
  std::vector<hsize_t> shape{static_cast<hsize_t>(height), static_cast<hsize_t>(width)};
  if (kind == ImageKind::color) shape.push_back(3);
  return shape;
}

ImageWriter::ImageWriter(h5::Saver& group, std::string name, ImageKind kind,
                         const CameraInfo& camera)
    : group_(group), name_(std::move(name)), kind_(kind), camera_(camera) {}

void ImageWriter::append_bytes(std::span<const std::uint8_t> image, std::size_t element_bytes) {
  const auto shape = image_shape(kind_, camera_);
  std::size_t expected = element_bytes;
  for (hsize_t extent : shape) expected *= extent;
  if (image.size() != expected || image.empty())
    throw failure(fmt::format("{} image {} does not have the camera's size of {} x {} pixels",
                              name_, frames_, shape[1], shape[0]),
                  "check CameraInfo; all images of a recording have one size");
  if (!images_) images_.emplace(group_.id(), name_, stored_type(kind_), shape, 1);
  images_->append(image);
  ++frames_;
}

void ImageWriter::finish(const h5::Axis& frame, const std::string& axis_prefix) {
  if (!images_) return;
  const auto shape = image_shape(kind_, camera_);
  std::vector<h5::Axis> axes{frame, group_.axis(axis_prefix + "y", shape[0]),
                             group_.axis(axis_prefix + "x", shape[1])};
  if (kind_ == ImageKind::color) axes.push_back(group_.axis("rgb", 3));
  h5::Saver::describe(images_->dataset(), axes, dataset_info(kind_));
  if (kind_ == ImageKind::depth)
    h5::Saver::describe_packing(images_->dataset(), camera_.depth_unit_m);
  images_->close();
}

ImageReader::ImageReader(const h5::Loader& group, const std::string& name, ImageKind kind,
                         const CameraInfo& camera, std::size_t frames, double float_depth_unit_m)
    : path_(group.path(name)) {
  if (!group.has(name)) return;
  std::vector<h5::Axis> axes{{"frame", frames}};
  for (hsize_t extent : image_shape(kind, camera))
    axes.push_back({"", extent > 0 ? extent : h5::unknown_length});
  const bool is_float = kind == ImageKind::depth && group.is_float(name);
  if (is_float) counts_per_float_ = float_depth_unit_m / camera.depth_unit_m;
  images_ = group.open(name, is_float ? h5::element_type<float>() : stored_type(kind), axes,
                       dataset_info(kind));
  if (!images_) return;
  pixels_ = images_->row_bytes() / (is_float ? sizeof(float) : stored_type(kind).bytes);
}

void ImageReader::read_float_depth(std::size_t index, std::span<std::uint8_t> out) const {
  std::vector<float> depth(pixels_);
  images_->read(index, h5::bytes_of(depth));
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const std::uint16_t count = depth_count(depth[i] * counts_per_float_);
    std::memcpy(out.data() + i * sizeof count, &count, sizeof count);
  }
}

void ImageReader::read_bytes(std::size_t index, std::span<std::uint8_t> out,
                             const std::string& file) const {
  if (index >= frames())
    throw data_error(
        fmt::format("{}: {}: image {} requested, found {}", file, path_, index, frames()),
        "`touchtrace check` lists the contents");
  try {
    counts_per_float_ > 0.0 ? read_float_depth(index, out) : images_->read(index, out);
  } catch (const h5::H5Error& fault) {
    throw data_error(fmt::format("{}: {}: image {}: {}", file, path_, index, fault.what()),
                     "copy or record the file again");
  }
}

}  // namespace touchtrace
