#include "pipeline/scene/objects/object_file.h"

#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/toml_table.h"
#include "pipeline/scene/objects/mass.h"
#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double min_mass_kg = 0.001, max_mass_kg = 20.0;
constexpr double min_length_m = 0.001, max_length_m = 1.0;
constexpr std::size_t max_solids_in_file = 24;
constexpr double rounding = 1e-9;  // relative, of the file's decimal digits

Vector3d read_vector(TomlTable& table, const std::string& key, double min, double max) {
  const std::vector<double> values = table.numbers(key, 3, min, max);
  return {values[0], values[1], values[2]};
}

Vector3d read_vector_or(TomlTable& table, const std::string& key, double min, double max,
                        const Vector3d& otherwise) {
  return table.has(key) ? read_vector(table, key, min, max) : otherwise;
}

double read_length_m(TomlTable& table, const char* key) {
  return table.number(key, min_length_m, max_length_m);
}

Vector3d read_direction(TomlTable& table, const char* key, const Vector3d& otherwise) {
  const Vector3d v = read_vector_or(table, key, -1e3, 1e3, otherwise);
  if (!(v.norm() > 1e-3)) table.reject(key, "has no direction");
  return v.normalized();
}

void read_shape(TomlTable& table, Solid& solid) {
  solid.kind =
      static_cast<ShapeKind>(table.choice("shape", {"sphere", "box", "capsule", "cylinder"}));
  if (solid.kind == ShapeKind::box) {
    solid.size_m = read_vector(table, "half_size_m", min_length_m, max_length_m);
  } else {
    solid.size_m[0] = read_length_m(table, "radius_m");
    if (solid.kind != ShapeKind::sphere) solid.size_m[1] = read_length_m(table, "half_length_m");
  }
  const Vector3d axis = read_direction(table, "axis", Vector3d::UnitZ());
  solid.body_from_shape.linear() =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis).toRotationMatrix();
  solid.body_from_shape.translation() =
      read_vector_or(table, "center_m", -max_length_m, max_length_m, Vector3d::Zero());
}

double half_thickness_m(const Solid& solid) {
  switch (solid.kind) {
    case ShapeKind::box:
      return solid.size_m.minCoeff();
    case ShapeKind::cylinder:
      return std::min(solid.size_m[0], solid.size_m[1]);
    default:
      return solid.size_m[0];
  }
}

MassProperties read_mass(TomlTable& table, const Solid& solid) {
  const double wall_m =
      table.has("wall_m") ? table.number("wall_m", 1e-5, 0.999 * half_thickness_m(solid)) : 0.0;
  const MassProperties volume = volume_properties(solid, wall_m);
  if (table.has("mass_kg"))
    return scaled(volume, table.number("mass_kg", 1e-6, max_mass_kg) / volume.mass_kg);
  return scaled(volume, table.number("density_kg_per_m3", 0.1, 3e4));
}

/// Rejects an inertia that no mass distribution within `reach_m` of the centre of mass has.
void check_inertia(TomlTable& body, const MassProperties& mass, double reach_m) {
  const Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(mass.inertia_kg_m2, Eigen::EigenvaluesOnly)
          .eigenvalues();
  const double largest = moments[2];
  if (!(moments[0] > 0.0)) body.reject("inertia_kg_m2", "is not positive definite");
  if (!(moments[0] + moments[1] >= largest * (1 - rounding)))
    body.reject("inertia_kg_m2", "violates the triangle inequality of principal moments");
  if (!(largest <= mass.mass_kg * reach_m * reach_m * (1 + rounding)))
    body.reject("inertia_kg_m2", "is larger than that of all mass at the solids' farthest point");
  if (!(moments[0] >= 1e-8 * mass.mass_kg))
    body.reject("inertia_kg_m2", "is that of a body thinner than a tenth of a millimetre");
}

Vector3d mean_center(const std::vector<Solid>& solids) {
  Vector3d sum = Vector3d::Zero();
  for (const Solid& solid : solids) sum += solid.body_from_shape.translation();
  return sum / static_cast<double>(solids.size());
}

/// Distance from `center` that no point of the solids exceeds.
double reach_m(const std::vector<Solid>& solids, const Vector3d& center) {
  double reach = 0.0;
  for (Solid solid : solids) {
    solid.body_from_shape.pretranslate(-center);
    reach = std::max(reach, bounding_radius_m(solid));
  }
  return reach;
}

MassProperties read_body(TomlTable& body, const std::vector<Solid>& solids) {
  MassProperties mass;
  mass.mass_kg = body.number("mass_kg", min_mass_kg, max_mass_kg);
  mass.center_m = read_vector(body, "center_m", -max_length_m, max_length_m);
  const auto i = body.numbers("inertia_kg_m2", 6, -1e3, 1e3);
  mass.inertia_kg_m2 << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
  if (!((mass.center_m - mean_center(solids)).norm() <= reach_m(solids, mean_center(solids))))
    body.reject("center_m", "is outside of the solids");
  check_inertia(body, mass, reach_m(solids, mass.center_m));
  return mass;
}

Hold read_hold(TomlTable& table) {
  Hold hold;
  hold.center_m = read_vector_or(table, "center_m", -max_length_m, max_length_m, hold.center_m);
  hold.across = read_direction(table, "across", hold.across);
  const Vector3d up = read_direction(table, "from_palm", hold.from_palm);
  hold.from_palm = up - hold.across * hold.across.dot(up);
  if (!(hold.from_palm.norm() > 1e-3)) table.reject("from_palm", "is parallel to `across`");
  hold.from_palm.normalize();
  if (table.has("turns"))
    hold.turns = static_cast<Hold::Turns>(table.choice("turns", {"none", "axis", "faces", "any"}));
  return hold;
}

Ball read_ball(TomlTable& table) {
  Ball ball;
  ball.radius_m = read_length_m(table, "radius_m");
  ball.mass_kg = table.number("mass_kg", 1e-4, 1.0);
  ball.drag_coefficient = table.number("drag_coefficient", 0.0, 2.0);
  ball.restitution = table.number("restitution", 0.0, 1.0);
  ball.friction = table.number("friction", 0.0, 3.0);
  // "meets_m": former name
  ball.face_center_m = read_vector(table, table.has("meets_m") ? "meets_m" : "face_center_m",
                                   -max_length_m, max_length_m);
  ball.color = read_vector(table, "color", 0.0, 1.0);
  return ball;
}

class ObjectReader {
 public:
  explicit ObjectReader(ObjectSpec& object) : object_(object) {}

  void read(TomlTable& root) {
    object_.summary = root.text("summary", 100);
    object_.role =
        static_cast<ObjectRole>(root.choice("role", {"seen", "unseen", "outside", "tool"}));
    object_.friction = root.number("friction", 0.0, 3.0);
    if (root.has("toss_apex_m")) read_toss(root);
    object_.inertia_given = root.has("body");
    root.each("solid", max_solids_in_file, [&](TomlTable& table) { read_solid(table); });
    if (object_.solids.empty()) root.reject("solid", "is missing: an object has at least one");
    root.each("filling", max_solids_in_file, [&](TomlTable& table) {
      Solid filling;
      read_shape(table, filling);
      parts_.push_back(read_mass(table, filling));
    });
    root.table("body", [&](TomlTable& body) {
      if (!parts_.empty()) body.reject("mass_kg", "cannot be combined with [[filling]]");
      parts_ = {read_body(body, object_.solids)};
    });
    root.table("hold", [&](TomlTable& table) { object_.hold = read_hold(table); });
    root.table("ball", [&](TomlTable& table) { object_.ball = read_ball(table); });
    move_origin_to_center_of_mass(root);
    if (root.has("tracked_m")) read_tracked(root);
  }

 private:
  void read_toss(TomlTable& root) {
    const auto apex = root.numbers("toss_apex_m", 2, 0.02, 1.0);
    if (!(apex[0] <= apex[1])) root.reject("toss_apex_m", "is not [low, high]");
    object_.toss_apex_m = {apex[0], apex[1]};
  }

  void read_solid(TomlTable& table) {
    Solid& solid = object_.solids.emplace_back();
    read_shape(table, solid);
    solid.color = read_vector(table, "color", 0.0, 1.0);
    if (!object_.inertia_given) parts_.push_back(read_mass(table, solid));
  }

  void read_tracked(TomlTable& root) {
    if (object_.ball) root.reject("tracked_m", "cannot be combined with [ball]");
    object_.tracked_m = read_vector(root, "tracked_m", -max_length_m, max_length_m) - center_m_;
  }

  void move_origin_to_center_of_mass(TomlTable& root) {
    const MassProperties whole = combined(parts_);
    if (!(whole.mass_kg >= min_mass_kg && whole.mass_kg <= max_mass_kg))
      root.reject("mass", fmt::format("is {:g} kg in total, not in {:g} to {:g}", whole.mass_kg,
                                      min_mass_kg, max_mass_kg));
    object_.mass_kg = whole.mass_kg;
    object_.inertia_kg_m2 = whole.inertia_kg_m2;
    center_m_ = whole.center_m;
    for (Solid& solid : object_.solids) solid.body_from_shape.pretranslate(-whole.center_m);
    object_.hold.center_m -= whole.center_m;
    if (object_.ball) object_.ball->face_center_m -= whole.center_m;
  }

  ObjectSpec& object_;
  std::vector<MassProperties> parts_;
  Vector3d center_m_ = Vector3d::Zero();
};

}  // namespace

ObjectSpec parse_object(const std::string& name, const std::string& text,
                        const std::string& where) {
  ObjectSpec object;
  object.name = name;
  object.solids.clear();
  ObjectReader reader(object);
  read_toml(text, where, "pipeline/scene/objects/object_file.h describes the format",
            [&](TomlTable& root) { reader.read(root); });
  return object;
}

ObjectSpec read_object(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  const std::string letters = "abcdefghijklmnopqrstuvwxyz0123456789-_";
  if (name.empty() || name.size() > 40 || name.find_first_not_of(letters) != std::string::npos)
    throw data_error(fmt::format("{}: invalid object name '{}'", file.string(), name),
                     "use a file name of at most 40 characters a-z, 0-9, - and _");
  return parse_object(name, read_file(file, 1 << 16), file.string());
}

ObjectSpec load_object(const std::string& name_or_file) {
  return name_or_file.ends_with(".toml") ? read_object(name_or_file) : find_object(name_or_file);
}

}  // namespace touchtrace::scene
