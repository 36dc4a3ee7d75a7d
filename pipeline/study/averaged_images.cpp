#include "pipeline/study/averaged_images.h"

#include <fmt/core.h>

#include <span>

#include "engine/base/error.h"
#include "pipeline/dataset/tactile_image.h"

namespace touchtrace::study {

std::optional<std::vector<float>> averaged_images(const ModelSpec& spec, const std::string& model,
                                                  const Dataset& data,
                                                  const std::string& recording) {
  if (!spec.touch || (spec.rows == data.rows && spec.cols == data.cols)) return std::nullopt;
  if (spec.rows > data.rows || spec.cols > data.cols)
    throw data_error(fmt::format("{} needs frames of {} x {}, {} has {} x {}", model, spec.rows,
                                 spec.cols, recording, data.rows, data.cols),
                     "use recordings of a glove with at least as many taxels");
  const AreaAverage average(data.rows, data.cols, spec.rows, spec.cols);
  const std::size_t in = std::size_t(data.rows) * data.cols,
                    out = std::size_t(spec.rows) * spec.cols;
  std::vector<float> images(static_cast<std::size_t>(data.frames()) * out);
  for (std::size_t frame = 0; frame < static_cast<std::size_t>(data.frames()); ++frame)
    average.apply(std::span(data.tactile).subspan(frame * in, in),
                  std::span(images).subspan(frame * out, out));
  return images;
}

}  // namespace touchtrace::study
