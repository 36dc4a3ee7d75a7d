#include "pipeline/study/convolution_options.h"

namespace touchtrace::study {

void describe(OptionSet& set, ConvolutionOptions& o) {
  set.choice("tactile-kernel", o.kernel, "convolution kernel size", {"3", "5"});
  // At a resolution of 6, strides 1,1,1 keep 6 x 6 positions; 2,2,2 leave one.
  set.choice("tactile-strides", o.strides,
             "convolution strides, 1 or 2 each; use small ones for small frames",
             {"2,2,2", "2,2,1", "2,1,2", "2,1,1", "1,2,2", "1,2,1", "1,1,2", "1,1,1"})
      .value("A,B,C");
}

}  // namespace touchtrace::study
