#include <fmt/core.h>

#include "pipeline/cli/commands.h"
#include "pipeline/scene/objects/object_file.h"
#include "pipeline/scene/objects/solids.h"

namespace touchtrace::cli {
namespace {

using scene::ObjectSpec;

struct ObjectsOptions {
  std::vector<std::string> objects;
};

void describe(OptionSet& set, ObjectsOptions& o) {
  set.texts("object", o.objects, "object names or TOML files (default: all built-in objects)")
      .value("NAME");
}

std::string inertia_source(const ObjectSpec& object) {
  return object.inertia_given ? "given" : "computed";
}

nlohmann::json to_json(const ObjectSpec& object) {
  const auto& i = object.inertia_kg_m2;
  nlohmann::json row{{"name", object.name},
                     {"summary", object.summary},
                     {"role", role_name(object.role)},
                     {"mass_kg", object.mass_kg},
                     {"friction", object.friction},
                     {"inertia_kg_m2", {i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)}},
                     {"inertia", inertia_source(object)},
                     {"solids", object.solids.size()},
                     {"reach_m", bounding_radius_m(object)},
                     {"toss_apex_m", nullptr}};
  if (object.toss_apex_m) row["toss_apex_m"] = *object.toss_apex_m;
  return row;
}

void print_row(const ObjectSpec& object) {
  const auto& apex = object.toss_apex_m;
  fmt::print("{:<13} {:<8} {:>6.0f} {:>8.2f} {:>9.0f} {:<9} {:<9} {}\n", object.name,
             role_name(object.role), 1e3 * object.mass_kg, object.friction,
             1e3 * bounding_radius_m(object), inertia_source(object),
             apex ? fmt::format("{:.0f}-{:.0f}", 1e2 * (*apex)[0], 1e2 * (*apex)[1]) : "-",
             object.summary);
}

ExitCode run(const ObjectsOptions& options, const Invocation& invocation) {
  std::vector<ObjectSpec> selected;
  for (const std::string& name : options.objects) selected.push_back(scene::load_object(name));
  if (selected.empty()) selected = scene::objects();
  if (invocation.json) {
    nlohmann::json rows = nlohmann::json::array();
    for (const ObjectSpec& object : selected) rows.push_back(to_json(object));
    fmt::print("{}\n", nlohmann::json{{"objects", rows}}.dump(2));
    return ExitCode::done;
  }
  fmt::print("{:<13} {:<8} {:>6} {:>8} {:>9} {:<9} {:<9}\n", "object", "role", "mass/g", "friction",
             "radius/mm", "inertia", "toss/cm");
  for (const ObjectSpec& object : selected) print_row(object);
  return ExitCode::done;
}

}  // namespace

Command objects_command() {
  return make_command<ObjectsOptions>(
      "objects", "list the objects of the simulated scenes, or check an object's TOML file",
      {"touchtrace objects", "touchtrace objects --object hammer my_mug.toml --json"}, run);
}

}  // namespace touchtrace::cli
