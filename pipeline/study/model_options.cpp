#include "pipeline/study/model_options.h"

namespace touchtrace::study {
namespace {

ObjectEncoder object_encoder_of(const ModelOptions& options, std::size_t num_objects) {
  if (options.without_touch || num_objects < 2 || options.object_encoder == "none")
    return ObjectEncoder::none;
  return options.object_encoder == "joint" ? ObjectEncoder::joint : ObjectEncoder::frozen;
}

}  // namespace

void describe(OptionSet& set, ModelOptions& o) {
  set.group("Model");
  set.flag("without-touch", o.without_touch, "baseline without tactile input");
  set.integer("window", o.window, "tactile frames per window, 1-32", 1, 32);
  set.integer("resolution", o.resolution,
              "tactile rows and columns, 1-64; 0: 32, or the glove's own if it has fewer", 0, 64);
  set.choice("tactile-kernel", o.tactile_kernel, "convolution kernel size", {"3", "5"});
  // At a resolution of 6, strides 1,1,1 keep 6 x 6 positions; 2,2,2 leave one.
  set.choice("tactile-strides", o.tactile_strides,
             "convolution strides, 1 or 2 each; use small ones for small frames",
             {"2,2,2", "2,2,1", "2,1,2", "2,1,1", "1,2,2", "1,2,1", "1,1,2", "1,1,1"})
      .value("A,B,C");
  set.choice("dynamics", o.dynamics, "state transition model", {"mlp", "gru"});
  set.choice("object-encoder", o.object_encoder, "auto: none for one object, else frozen",
             {"auto", "none", "frozen", "joint"});
}

ModelSpec make_spec(const ModelOptions& options, int rows, int cols, std::size_t num_objects) {
  ModelSpec spec;
  spec.touch = !options.without_touch;
  spec.window_frames = options.window;
  spec.rows = rows;
  spec.cols = cols;
  spec.tactile_kernel = options.kernel_size();
  spec.tactile_strides = options.stride_sizes();
  spec.object = object_encoder_of(options, num_objects);
  spec.dynamics = dynamics_of(options.dynamics);
  validate(spec);
  return spec;
}

}  // namespace touchtrace::study
