#include "tests/verify/scene/small_oscillations.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "pipeline/scene/base/rotation.h"
#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Square = Eigen::Matrix<double, small_count, small_count>;

constexpr double difference = 1e-4;  // [m] or [rad], for finite differences

/// Spring of a taxel along the face's normal, and that of friction across it.
struct Spring {
  const Taxel* taxel;
  double k, depth_m;                    ///< present depth
  Vector3d normal, place_m, relaxed_m;  ///< object's frame; relaxed_m: friction's spring at rest
};

/// Position of a taxel in the frame of the displaced object.
Vector3d point_in_object(const World& world, const Taxel& taxel, const SmallDisplacement& q) {
  Vector3d in_hand = taxel.position_m;
  if (taxel.finger >= 0) {
    const double flexion = world.flexion_rad[taxel.finger] + q[small_flexion + taxel.finger];
    const FingerPose pose = pose_finger(world.model().fingers[taxel.finger], flexion);
    in_hand = pose.joint_m[taxel.link] + pose.hand_from_link[taxel.link] * in_hand;
  }
  const Vector3d place = world.hand.position_m + world.hand.orientation * in_hand;
  const Matrix3d turn = (rotation_from_vector(q.segment<3>(small_turn)) * world.object.orientation)
                            .toRotationMatrix();
  return turn.transpose() * (place - world.object.position_m - q.segment<3>(small_place));
}

std::vector<Spring> springs_of(const World& world, const FirstContacts& contacts,
                               const ContactParameters& contact) {
  std::vector<Spring> springs;
  for (std::size_t i = 0; i < world.model().taxels.size(); ++i) {
    const Taxel& taxel = world.model().taxels[i];
    const Vector3d place = point_in_object(world, taxel, SmallDisplacement::Zero());
    const Distance d = distance(world.spec(), place);
    if (d.value_m < 0.0)
      springs.push_back({&taxel, contact.stiffness_n_per_m3 * taxel.area_m2, -d.value_m, d.normal,
                         place, contacts.point_m()[i]});
  }
  return springs;
}

double energy_j(const World& world, const std::vector<Spring>& springs, const Drive& drive,
                double bristle_ratio, const SmallDisplacement& q) {
  double energy = world.spec().mass_kg * gravity_m_per_s2 * q[small_place + 2];
  for (const Spring& s : springs) {
    const Vector3d place = point_in_object(world, *s.taxel, q);
    const double depth = s.depth_m - s.normal.dot(place - s.place_m);
    Vector3d stretch = place - s.relaxed_m;
    stretch -= s.normal * s.normal.dot(stretch);
    energy += 0.5 * s.k * (depth * depth + bristle_ratio * stretch.squaredNorm());
  }
  for (int i = 0; i < num_fingers; ++i) {
    const double flexion = world.flexion_rad[i] + q[small_flexion + i];
    const double off = flexion - drive.fingers[i].rest_rad;
    energy += 0.5 * drive.fingers[i].stiffness_nm_per_rad * off * off -
              drive.fingers[i].torque_nm * flexion;
  }
  return energy;
}

SmallDisplacement step_along(int i) { return difference * SmallDisplacement::Unit(i); }

/// Central second differences, with an error of about 1e-8 of the largest element.
template <typename Energy>
Square second_derivatives(const Energy& energy) {
  Square k;
  for (int i = 0; i < small_count; ++i)
    for (int j = 0; j <= i; ++j) {
      const SmallDisplacement a = step_along(i), b = step_along(j);
      k(i, j) = k(j, i) = (energy(a + b) - energy(a - b) - energy(b - a) + energy(-a - b)) /
                          (4.0 * difference * difference);
    }
  return k;
}

/// Damping of the springs: k d c along the normal, times bristle_ratio across it.
Square damping_of(const World& world, const std::vector<Spring>& springs,
                  const ContactParameters& contact) {
  Square c = Square::Zero();
  for (const Spring& s : springs) {
    Eigen::Matrix<double, 3, small_count> way;
    for (int i = 0; i < small_count; ++i)
      way.col(i) = (point_in_object(world, *s.taxel, step_along(i)) -
                    point_in_object(world, *s.taxel, -step_along(i))) /
                   (2.0 * difference);
    const Matrix3d along = s.normal * s.normal.transpose();
    const Matrix3d share = along + contact.bristle_ratio * (Matrix3d::Identity() - along);
    c += s.k * s.depth_m * contact.dissipation_s_per_m * way.transpose() * share * way;
  }
  c.diagonal().tail<num_fingers>().array() += FingerParameters{}.damping_nm_s_per_rad;
  return c;
}

}  // namespace

FirstContacts::FirstContacts(const World& world) : touching_(world.model().taxels.size(), true) {
  for (const Taxel& taxel : world.model().taxels)
    point_m_.push_back(point_in_object(world, taxel, SmallDisplacement::Zero()));
}

void FirstContacts::update(const World& world) {
  for (std::size_t i = 0; i < touching_.size(); ++i) {
    const bool touching = world.contact().force_n()[i] > 0.0;
    if (touching && !touching_[i])
      point_m_[i] = point_in_object(world, world.model().taxels[i], SmallDisplacement::Zero());
    touching_[i] = touching;
  }
}

SmallOscillations::SmallOscillations(const World& world, const FirstContacts& contacts,
                                     const Drive& drive, const ContactParameters& contact) {
  const std::vector<Spring> springs = springs_of(world, contacts, contact);
  const Matrix3d turn = world.object.orientation.toRotationMatrix();
  mass_.setZero();
  mass_.diagonal().segment<3>(small_place).setConstant(world.spec().mass_kg);
  mass_.block<3, 3>(small_turn, small_turn) = turn * world.spec().inertia_kg_m2 * turn.transpose();
  mass_.diagonal().tail<num_fingers>().setConstant(FingerParameters{}.inertia_kg_m2);
  damping_ = damping_of(world, springs, contact);
  stiffness_ = second_derivatives([&](const SmallDisplacement& q) {
    return energy_j(world, springs, drive, contact.bristle_ratio, q);
  });
}

SmallDisplacement SmallOscillations::free(const SmallDisplacement& velocity, double seconds) const {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Square> modes(stiffness_, mass_);
  SmallDisplacement amplitude = modes.eigenvectors().transpose() * mass_ * velocity;
  for (int i = 0; i < small_count; ++i) {
    const double rate = std::sqrt(std::abs(modes.eigenvalues()[i]));
    amplitude[i] *=
        (modes.eigenvalues()[i] > 0.0 ? std::sin(rate * seconds) : std::sinh(rate * seconds)) /
        rate;
  }
  return modes.eigenvectors() * amplitude;
}

Eigen::Vector3cd SmallOscillations::response(const Vector3d& direction,
                                             double rate_rad_per_s) const {
  using Complex = std::complex<double>;
  const Eigen::Matrix<Complex, small_count, small_count> system =
      (stiffness_ - rate_rad_per_s * rate_rad_per_s * mass_).cast<Complex>() +
      Complex(0.0, rate_rad_per_s) * damping_.cast<Complex>();
  SmallDisplacement inertia = SmallDisplacement::Zero();
  inertia.segment<3>(small_place) = -mass_(0, 0) * direction;
  const Eigen::Matrix<Complex, small_count, 1> q =
      system.partialPivLu().solve(inertia.cast<Complex>());
  return q.segment<3>(small_place);
}

}  // namespace touchtrace::scene
