#pragma once

#include <Eigen/Core>

namespace touchtrace {

// Products of matrices of any size. Their code is compiled once, here: in each file that multiplies
// two dynamic Eigen matrices it takes seconds.

/// a b.
Eigen::MatrixXd product(const Eigen::Ref<const Eigen::MatrixXd>& a,
                        const Eigen::Ref<const Eigen::MatrixXd>& b);

/// a b a', such as the covariance of a x, where b is the covariance of x.
Eigen::MatrixXd congruence(const Eigen::Ref<const Eigen::MatrixXd>& a,
                           const Eigen::Ref<const Eigen::MatrixXd>& b);

}  // namespace touchtrace
