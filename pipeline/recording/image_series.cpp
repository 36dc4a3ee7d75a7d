#include "pipeline/recording/image_series.h"

#include <fmt/core.h>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

constexpr h5::Meaning color_meaning{"1", "colour image, RGB"};
constexpr h5::Meaning depth_meaning{"m", "depth image; counts times scale_factor, 0: not measured"};

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
    throw failure(fmt::format("image {} has not the camera's {} x {} pixels", frames_,
                              camera_.width, camera_.height),
                  "give every image the size of the camera");
  color_->append(h5::bytes_of(frame.color));
  if (depth_) depth_->append(h5::bytes_of(frame.depth));
  ++frames_;
}

void ImageSeriesWriter::finish(std::optional<h5::Axis> time) {
  if (!color_) return;
  const h5::Axis frame = time ? *time : group_.axis("frame", frames_);
  const h5::Axis y = group_.axis("y", extent(camera_.height)),
                 x = group_.axis("x", extent(camera_.width));
  h5::Saver::describe(color_->dataset(), {frame, y, x, group_.axis("rgb", 3)}, color_meaning);
  color_->close();
  if (!depth_) return;
  h5::Saver::describe(depth_->dataset(), {frame, y, x}, depth_meaning);
  h5::Saver::describe_packing(depth_->dataset(), camera_.depth_unit_m);
  depth_->close();
}

ImageSeriesReader::ImageSeriesReader(const h5::Loader& group, const CameraInfo& camera) {
  if (!group.has("color")) return;
  color_.emplace(group.open("color", h5::element_type<std::uint8_t>(), color_meaning));
  const h5::Axis frame{"frame", color_->rows()}, y = group.axis("y", extent(camera.height)),
                                                 x = group.axis("x", extent(camera.width));
  group.check_shape("color", *color_, {frame, y, x, group.axis("rgb", 3)});
  if (!group.has("depth")) return;
  depth_.emplace(group.open("depth", h5::element_type<std::uint16_t>(), depth_meaning));
  group.check_shape("depth", *depth_, {frame, y, x});
}

RgbdFrame ImageSeriesReader::read(std::size_t index, const std::string& file) const {
  if (index >= frames())
    throw data_error(fmt::format("{} has no image {}", file, index),
                     fmt::format("it has {}; `touchtrace check` says what it holds", frames()));
  RgbdFrame frame;
  try {
    frame.color.resize(color_->row_bytes());
    color_->read(index, h5::bytes_of(frame.color));
    if (!depth_) return frame;
    frame.depth.resize(depth_->row_bytes() / sizeof(std::uint16_t));
    depth_->read(index, h5::bytes_of(frame.depth));
  } catch (const h5::H5Error& fault) {
    throw data_error(fmt::format("{}, image {}: {}", file, index, fault.what()),
                     "copy the file again from where it came from, or make it again");
  }
  return frame;
}

}  // namespace touchtrace
