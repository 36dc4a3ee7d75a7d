#include "pipeline/recording/image_series.h"

#include <fmt/core.h>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

constexpr h5::DatasetInfo color_info{"1", "colour image, RGB"};
constexpr h5::DatasetInfo depth_info{"m", "depth = count * scale_factor; 0: no measurement"};

hsize_t extent(int pixels) { return static_cast<hsize_t>(pixels); }

}  // namespace

ImageSeriesWriter::ImageSeriesWriter(h5::Saver group, const CameraInfo& camera)
    : group_(std::move(group)), camera_(camera) {}

void ImageSeriesWriter::create(const RgbdFrame& first) {
  const hsize_t height = extent(camera_.height), width = extent(camera_.width);
  color_.emplace(group_.id(), "color", h5::element_type<std::uint8_t>(),
                 std::vector<hsize_t>{height, width, 3}, 1);
  if (!first.depth.empty())
    depth_.emplace(group_.id(), "depth", h5::element_type<std::uint16_t>(),
                   std::vector<hsize_t>{height, width}, 1);
}

void ImageSeriesWriter::append(const RgbdFrame& frame) {
  if (!color_) create(frame);
  const std::size_t pixels = extent(camera_.width) * extent(camera_.height);
  if (pixels == 0 || frame.color.size() != 3 * pixels ||
      frame.depth.size() != (depth_ ? pixels : 0))
    throw failure(fmt::format("image {} does not have the camera's size of {} x {} pixels", frames_,
                              camera_.width, camera_.height),
                  "check CameraInfo; all images of a recording have one size");
  color_->append(h5::bytes_of(frame.color));
  if (depth_) depth_->append(h5::bytes_of(frame.depth));
  ++frames_;
}

void ImageSeriesWriter::finish(std::optional<h5::Axis> time) {
  if (!color_) return;
  const h5::Axis frame = time ? *time : group_.axis("frame", frames_);
  const h5::Axis y = group_.axis("y", extent(camera_.height)),
                 x = group_.axis("x", extent(camera_.width));
  h5::Saver::describe(color_->dataset(), {frame, y, x, group_.axis("rgb", 3)}, color_info);
  color_->close();
  if (!depth_) return;
  h5::Saver::describe(depth_->dataset(), {frame, y, x}, depth_info);
  h5::Saver::describe_packing(depth_->dataset(), camera_.depth_unit_m);
  depth_->close();
}

ImageSeriesReader::ImageSeriesReader(const h5::Loader& group, const CameraInfo& camera)
    : path_(group.path()) {
  if (!group.has("color")) return;
  const h5::Axis y = group.axis("y", extent(camera.height)),
                 x = group.axis("x", extent(camera.width)), rgb = group.axis("rgb", 3);
  h5::Axis frame{"frame"};
  color_ = group.open("color", h5::element_type<std::uint8_t>(), {frame, y, x, rgb}, color_info);
  if (!group.has("depth")) return;
  if (color_) frame.length = color_->rows();
  depth_ = group.open("depth", h5::element_type<std::uint16_t>(), {frame, y, x}, depth_info);
}

RgbdFrame ImageSeriesReader::read(std::size_t index, const std::string& file) const {
  if (index >= frames())
    throw data_error(
        fmt::format("{}: {}/color: image {} requested, found {}", file, path_, index, frames()),
        "`touchtrace check` lists the contents");
  RgbdFrame frame;
  frame.color.resize(color_->row_bytes());
  read(*color_, index, h5::bytes_of(frame.color), file + ": " + path_ + "/color");
  if (!depth_) return frame;
  frame.depth.resize(depth_->row_bytes() / sizeof(std::uint16_t));
  read(*depth_, index, h5::bytes_of(frame.depth), file + ": " + path_ + "/depth");
  return frame;
}

void ImageSeriesReader::read(const h5::ArrayReader& images, std::size_t index,
                             std::span<std::uint8_t> out, const std::string& name) const {
  try {
    images.read(index, out);
  } catch (const h5::H5Error& fault) {
    throw data_error(fmt::format("{}: image {}: {}", name, index, fault.what()),
                     "copy or record the file again");
  }
}

}  // namespace touchtrace
