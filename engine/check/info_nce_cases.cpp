// Operation `info_nce`. Inputs: embeddings [N, columns], objects [N], weights [N]. Output: loss of
// each anchor.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/check/info_nce_check.h"
#include "engine/check/rows.h"

namespace touchtrace {
namespace {

struct InfoNceShape {
  int count, columns, objects;
  float temperature;
};

InfoNceProblem info_nce_problem(const InfoNceShape& s, const Arrays& in) {
  return {s.columns, s.temperature, in[0], {in[1].begin(), in[1].end()}, in[2]};
}

/// Inputs with weights such that the loss equals sum(output * output_gradient).
Arrays info_nce_weighted(Arrays in, const Arrays& grads) {
  for (std::size_t i = 0; i < in[2].size(); ++i) in[2][i] *= grads[0][i];
  return in;
}

OperationCase info_nce_case(const InfoNceShape& s) {
  OperationCase c;
  c.shape = fmt::format("{} embeddings of {} values and {} objects, temperature {}", s.count,
                        s.columns, s.objects, s.temperature);
  const auto count = std::size_t(s.count);
  c.input_sizes = {count * s.columns, count, count};
  c.terms = s.columns + s.count;
  c.reference = [s](const Arrays& in) {
    return Arrays{info_nce_reference(info_nce_problem(s, in)).row_loss};
  };
  c.forward = [s](Runtime& runtime, const Arrays& in) {
    return Arrays{info_nce_on_device(runtime, info_nce_problem(s, in)).row_loss};
  };
  c.reference_backward = [s](const Arrays& in, const Arrays& grads) {
    const auto weighted = info_nce_problem(s, info_nce_weighted(in, grads));
    return Arrays{info_nce_reference(weighted).grad_embedding, {}, {}};
  };
  c.backward = [s](Runtime& runtime, const Arrays& in, const Arrays& grads) {
    const auto weighted = info_nce_problem(s, info_nce_weighted(in, grads));
    return Arrays{info_nce_on_device(runtime, weighted).grad_embedding, {}, {}};
  };
  c.prepare = [s](Arrays& in) {
    for (double& object : in[1]) object = std::floor(std::fmod(std::abs(object) * 1e3, s.objects));
    in[1].front() = 0, in[1].back() = s.objects - 1;  // at least two objects and one positive pair
    in[1][1] = 0;
    for (double& weight : in[2]) weight = std::abs(weight);
  };
  return c;
}

}  // namespace

Operation info_nce_operation() {
  Operation operation{"info_nce", {}};
  for (const InfoNceShape& shape : {InfoNceShape{5, 16, 2, 0.5f},
                                    {5, 16, 2, 0.0f},
                                    {8, 64, 3, 0.0f},
                                    {33, 32, 4, 0.1f},
                                    {64, 64, 8, 0.0f}})
    operation.cases.push_back(info_nce_case(shape));
  return operation;
}

}  // namespace touchtrace
