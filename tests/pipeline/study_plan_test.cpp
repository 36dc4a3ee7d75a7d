// Options of a model, its specification, and what it leaves out.
#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/study/model_options.h"
#include "pipeline/study/plan.h"

namespace touchtrace::study {
namespace {

TEST(ModelOptions, ParseStridesInOrder) {
  ModelOptions options;
  EXPECT_EQ(options.kernel_size(), 3);
  EXPECT_EQ(options.stride_sizes(), (std::array{2, 2, 2}));
  options.tactile_kernel = "5", options.tactile_strides = "2,1,2";
  const auto spec = make_spec(options, 16, 8, 1);
  EXPECT_EQ(spec.tactile_kernel, 5);
  EXPECT_EQ(spec.tactile_strides, (std::array{2, 1, 2}));
  EXPECT_EQ(spec.rows, 16);
  EXPECT_EQ(spec.cols, 8);
}

TEST(ModelOptions, RejectUnsupportedValues) {
  for (const auto& [kernel, strides] :
       {std::pair{"4", "2,2,2"}, {"3", "2,2"}, {"3", "2,2,3"}, {"", ""}}) {
    ModelOptions options;
    options.tactile_kernel = kernel, options.tactile_strides = strides;
    OptionSet set;
    describe(set, options);
    EXPECT_THROW(set.validate(), Error) << kernel << " " << strides;
  }
  EXPECT_THROW(make_spec({}, 65, 32, 1), Error);
}

TEST(ModelOptions, ObjectEncoderNeedsTouchAndSeveralObjects) {
  for (const auto& [name, encoder] : {std::pair{"auto", ObjectEncoder::frozen},
                                      {"frozen", ObjectEncoder::frozen},
                                      {"joint", ObjectEncoder::joint},
                                      {"none", ObjectEncoder::none}}) {
    ModelOptions options;
    options.object_encoder = name;
    EXPECT_EQ(make_spec(options, 32, 32, 2).object, encoder) << name;
    EXPECT_EQ(make_spec(options, 32, 32, 1).object, ObjectEncoder::none) << name;
    options.without_touch = true;
    EXPECT_EQ(make_spec(options, 32, 32, 2).object, ObjectEncoder::none) << name;
  }
}

TEST(ImageShape, IsTheGlovesIfItIsSmall) {
  const auto shape = [](GloveInfo glove, int resolution) {
    const auto [rows, cols] = image_shape(glove, resolution);
    return std::pair(rows, cols);
  };
  GloveInfo small, large;
  small.rows = 21, small.cols = 40, large.rows = 48, large.cols = 64;
  EXPECT_EQ(shape(small, 0), std::pair(21, 40));
  EXPECT_EQ(shape(large, 0), std::pair(32, 32));
  EXPECT_EQ(shape(large, own_resolution), std::pair(48, 64));
  EXPECT_EQ(shape(large, 16), std::pair(16, 16));
}

/// Included parts and skipped ones, by name.
std::pair<std::vector<std::string>, std::vector<std::string>> parts_of(const PlanRequest& request) {
  std::pair<std::vector<std::string>, std::vector<std::string>> parts;
  for (const PlanItem& item : plan_items(request)) {
    EXPECT_FALSE(item.why.empty()) << item.part;
    (item.included ? parts.first : parts.second).push_back(item.part);
  }
  return parts;
}

using Parts = std::vector<std::string>;

TEST(Plan, SkipsWhatOneObjectDoesNotNeed) {
  const auto [included, skipped] = parts_of({});
  EXPECT_EQ(included, (Parts{"hand, object and contact", "glove", "camera", "tactile encoder",
                             "convolution of dead taxels", "full"}));
  EXPECT_EQ(skipped, (Parts{"object encoder", "contrastive loss", "without embedding"}));
}

TEST(Plan, SkipsSimulationAndTouchOfARecordingWithoutTouch) {
  PlanRequest request{.objects = {"a", "b"}, .is_simulated = false};
  request.spec.touch = false;
  const auto [included, skipped] = parts_of(request);
  EXPECT_TRUE(included.empty()) << included.front();
  EXPECT_EQ(skipped.size(), 8u);
}

TEST(Plan, SkipsOutputsOfDeadTaxels) {
  PlanRequest request{.spec = {.rows = 8, .cols = 8}, .live = LiveTaxels(64, 1)};
  EXPECT_EQ(parts_of(request).second,
            (Parts{"object encoder", "contrastive loss", "without embedding"}));
  std::fill_n(request.live.begin(), 32, 0);
  EXPECT_EQ(parts_of(request).second.front(), "convolution of dead taxels");
}

}  // namespace
}  // namespace touchtrace::study
