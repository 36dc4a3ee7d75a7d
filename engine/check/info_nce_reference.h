#pragma once

#include <vector>

namespace touchtrace {

struct InfoNceProblem {
  int columns;
  float temperature;  ///< 0: dot products
  std::vector<double> embedding;
  std::vector<int> object;
  std::vector<double> weight;
};

struct InfoNceResult {
  std::vector<double> row_loss, grad_embedding;  ///< of sum(row_loss)
};

/// InfoNCE loss in plain loops.
InfoNceResult info_nce_reference(const InfoNceProblem& problem);

}  // namespace touchtrace
