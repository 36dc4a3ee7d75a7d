#include "pipeline/label/estimate/shape_problem.h"

#include "calib/matrix/decomposition.h"
#include "calib/matrix/product.h"

namespace touchtrace::label {
namespace {

constexpr int max_iterations = 25;
constexpr double min_radius_m = 0.002;
/// Tikhonov regularisation, relative to the largest diagonal element: a cylinder's rotation about
/// its axis is unobservable.
constexpr double regularisation = 1e-9;

}  // namespace

ShapeProblem::ShapeProblem(const std::vector<BodyView>& views, const RoundedBody& body,
                           const Poses& poses, double loss_width_m, double compactness)
    : core_(body.core),
      shape_{body.inner_m.x(), body.inner_m.y(), body.inner_m.z(), body.radius_m},
      poses_(poses.begin(), poses.end()) {
  for (std::size_t i = 0; i < views.size(); ++i) add_view(views[i], poses_[i], loss_width_m);
  problem_.AddResidualBlock(new residuals::Compactness(core_, compactness), nullptr, shape_.data());
  for (int i = 0; i < 3; ++i) problem_.SetParameterLowerBound(shape_.data(), i, 0.0);
  problem_.SetParameterLowerBound(shape_.data(), 3, min_radius_m);
}

void ShapeProblem::add_view(const BodyView& view, Pose& pose, double loss_width_m) {
  const auto add = [&](residuals::BodyResidual* residual, ceres::LossFunction* loss) {
    problem_.AddResidualBlock(residual, loss, shape_.data(), pose.rotation.coeffs().data(),
                              pose.position_m.data());
  };
  for (const auto& point : view.surface_points)
    add(new residuals::PointDistance(view, core_, point.cast<double>()),
        new residuals::SquaredGemanMcClureLoss(loss_width_m));
  for (const auto& end : view.free_space_endpoints)
    add(new residuals::RayDepth(core_, view.origin_m, end.cast<double>()),
        new residuals::SquaredGemanMcClureLoss(loss_width_m));
  for (const auto& outward : view.box.outward)
    add(new residuals::PlaneDistance(view.box, core_, outward),
        new ceres::HuberLoss(plane_loss.width_m));
  problem_.SetManifold(pose.rotation.coeffs().data(), new ceres::EigenQuaternionManifold);
}

void ShapeProblem::solve() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = max_iterations;
  options.max_num_line_search_step_size_iterations = 0;  // steps are projected onto the bounds
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
}

ShapeProblem::Poses ShapeProblem::poses() const {
  Poses result;
  for (const auto& [rotation, position_m] : poses_) {
    Eigen::Isometry3d pose(rotation);
    pose.pretranslate(position_m);
    result.push_back(pose);
  }
  return result;
}

Eigen::MatrixXd ShapeProblem::normal_matrix() {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks.push_back(shape_.data());
  for (auto& pose : poses_) {
    options.parameter_blocks.push_back(pose.rotation.coeffs().data());
    options.parameter_blocks.push_back(pose.position_m.data());
  }
  ceres::CRSMatrix crs;
  problem_.Evaluate(options, nullptr, nullptr, nullptr, &crs);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(crs.num_cols, crs.num_cols);
  for (std::size_t row = 0; row + 1 < crs.rows.size(); ++row)
    for (auto a = std::size_t(crs.rows[row]); a < std::size_t(crs.rows[row + 1]); ++a)
      for (auto b = std::size_t(crs.rows[row]); b < std::size_t(crs.rows[row + 1]); ++b)
        normal(crs.cols[a], crs.cols[b]) += crs.values[a] * crs.values[b];
  return normal;
}

Eigen::Vector3d ShapeProblem::half_extent_sigma_m() {
  Eigen::MatrixXd normal = normal_matrix();
  normal.diagonal().array() += regularisation * normal.diagonal().maxCoeff();
  Eigen::MatrixXd half_extents = Eigen::MatrixXd::Zero(normal.rows(), 3);
  half_extents.topRows<4>() = residuals::half_extent_jacobian(core_).transpose();
  const Eigen::MatrixXd covariance =
      product(half_extents.transpose(), solve_semidefinite(normal, half_extents));
  return point_sigma_m * covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace touchtrace::label
