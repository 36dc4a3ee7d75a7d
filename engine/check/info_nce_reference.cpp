#include "engine/check/info_nce_reference.h"

#include <cmath>
#include <numeric>

namespace touchtrace {
namespace {

using Rows = std::vector<std::vector<double>>;

double inner(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

double length(const std::vector<double>& row) { return std::sqrt(inner(row, row) + 1e-24); }

Rows rows_of(const InfoNceProblem& problem) {
  Rows rows;
  for (auto at = problem.embedding.begin(); at != problem.embedding.end(); at += problem.columns)
    rows.emplace_back(at, at + problem.columns);
  return rows;
}

/// Vectors whose dot products are the logits: the embeddings, or unit vectors divided by
/// sqrt(temperature).
Rows factors_of(Rows rows, float temperature) {
  for (auto& row : rows) {
    const double scale =
        temperature > 0 ? 1.0 / (length(row) * std::sqrt(double{temperature})) : 1.0;
    for (double& value : row) value *= scale;
  }
  return rows;
}

/// -log(exp(positive) / (exp(positive) + sum of exp(negatives))) = log(1 + odds).
double log_odds(double positive, const std::vector<double>& negatives) {
  double top = negatives.front(), sum = 0.0;
  for (double logit : negatives) top = std::max(top, logit);
  for (double logit : negatives) sum += std::exp(logit - top);
  return top - positive + std::log(sum);
}

double log_one_plus_exp(double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }
double logistic(double x) { return 1.0 / (1.0 + std::exp(-x)); }

/// Adds the gradient of the dot product of factors i and j, times `slope`.
void add_slope(const Rows& factors, Rows& grad, std::size_t i, std::size_t j, double slope) {
  for (std::size_t d = 0; d < factors[i].size(); ++d) {
    grad[i][d] += slope * factors[j][d];
    grad[j][d] += slope * factors[i][d];
  }
}

/// Adds the loss of one anchor and its gradient with respect to the factors.
double add_anchor(const InfoNceProblem& problem, const Rows& factors, std::size_t i, Rows& grad) {
  std::vector<double> negatives;
  for (std::size_t j = 0; j < factors.size(); ++j)
    if (problem.object[j] != problem.object[i]) negatives.push_back(inner(factors[i], factors[j]));
  if (negatives.empty()) return 0.0;
  double loss = 0.0;
  for (std::size_t p = 0; p < factors.size(); ++p) {
    if (p == i || problem.object[p] != problem.object[i]) continue;
    const double odds = log_odds(inner(factors[i], factors[p]), negatives);
    const double pull = problem.weight[i] * logistic(odds);
    loss += problem.weight[i] * log_one_plus_exp(odds);
    add_slope(factors, grad, i, p, -pull);
    for (std::size_t j = 0; j < factors.size(); ++j)
      if (problem.object[j] != problem.object[i])
        add_slope(factors, grad, i, j,
                  pull * std::exp(-log_odds(inner(factors[i], factors[j]), negatives)));
  }
  return loss;
}

}  // namespace

InfoNceResult info_nce_reference(const InfoNceProblem& problem) {
  const Rows rows = rows_of(problem), factors = factors_of(rows, problem.temperature);
  Rows grad(rows.size(), std::vector<double>(std::size_t(problem.columns), 0.0));
  InfoNceResult result;
  for (std::size_t i = 0; i < rows.size(); ++i)
    result.row_loss.push_back(add_anchor(problem, factors, i, grad));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double along = inner(grad[i], rows[i]), n = length(rows[i]);
    for (std::size_t d = 0; d < rows[i].size(); ++d)
      result.grad_embedding.push_back(problem.temperature > 0
                                          ? (grad[i][d] - rows[i][d] * along / (n * n)) /
                                                (n * std::sqrt(double{problem.temperature}))
                                          : grad[i][d]);
  }
  return result;
}

}  // namespace touchtrace
