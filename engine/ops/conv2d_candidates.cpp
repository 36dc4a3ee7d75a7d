#include "engine/ops/conv2d_candidates.h"

#include "engine/ops/conv2d_methods.h"

namespace touchtrace {

Conv2dCandidates conv2d_candidates(const Runtime& runtime, const Conv2dShape& shape) {
  if (runtime.kernel_variant() == KernelVariant::gpu) return {};  // it has one configuration
  auto products = winograd_candidates(runtime, shape);
  auto direct = direct_candidates();
  // Where Winograd's method applies, other tiles of the direct method are hardly ever faster.
  if (!products.empty()) direct.resize(2);
  products.insert(products.end(), direct.begin(), direct.end());
  return {std::move(products), gradient_candidates(shape)};
}

Conv2dChoice joined(Conv2dChoice products, const Conv2dChoice& gradients) {
  products.gradient_images = gradients.gradient_images;
  products.gradient_chunks = gradients.gradient_chunks;
  return products;
}

}  // namespace touchtrace
