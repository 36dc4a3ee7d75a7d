#include "pipeline/study/convolution_options.h"

#include <gtest/gtest.h>

#include "engine/base/error.h"

namespace touchtrace::study {
namespace {

TEST(ConvolutionOptions, DefaultToThePapers) {
  const ConvolutionOptions options;
  EXPECT_EQ(options.kernel_size(), 3);
  EXPECT_EQ(options.stride_sizes(), (std::array{2, 2, 2}));
}

TEST(ConvolutionOptions, ParseStridesInOrder) {
  const ConvolutionOptions options{"5", "2,1,2"};
  EXPECT_EQ(options.kernel_size(), 5);
  EXPECT_EQ(options.stride_sizes(), (std::array{2, 1, 2}));
}

TEST(ConvolutionOptions, RejectUnsupportedValues) {
  for (const auto& [kernel, strides] :
       {std::pair{"4", "2,2,2"}, {"3", "2,2"}, {"3", "2,2,3"}, {"", ""}}) {
    ConvolutionOptions options{kernel, strides};
    OptionSet set;
    describe(set, options);
    EXPECT_THROW(set.validate(), Error) << kernel << " " << strides;
  }
}

}  // namespace
}  // namespace touchtrace::study
