#include "calib/matrix/product.h"

namespace touchtrace {

using Eigen::MatrixXd, Eigen::Ref;

MatrixXd product(const Ref<const MatrixXd>& a, const Ref<const MatrixXd>& b) { return a * b; }

MatrixXd congruence(const Ref<const MatrixXd>& a, const Ref<const MatrixXd>& b) {
  return product(product(a, b), a.transpose());
}

}  // namespace touchtrace
