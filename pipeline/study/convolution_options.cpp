#include "pipeline/study/convolution_options.h"

namespace touchtrace::study {

void describe(OptionSet& set, ConvolutionOptions& o) {
  set.choice("tactile-kernel", o.kernel,
             "rows and columns of taps of the convolutions over tactile frames", {"3", "5"});
  set.choice("tactile-strides", o.strides,
             "their strides, from the first to the last; small frames want small ones: at a "
             "resolution of 6, 1,1,1 keeps 6 x 6 places, where 2,2,2 leaves one",
             {"2,2,2", "2,2,1", "2,1,2", "2,1,1", "1,2,2", "1,2,1", "1,1,2", "1,1,1"});
}

}  // namespace touchtrace::study
