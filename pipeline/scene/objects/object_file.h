#pragma once

#include <filesystem>

#include "pipeline/scene/objects/object.h"

namespace touchtrace::scene {

/// Parses the TOML description of an object (pipeline/scene/objects/*.toml; format below). Throws
/// data_error if the text is invalid or the object is not physical.
///
///     summary = "a hammer"                 # one line
///     role = "seen"                        # "unseen", "outside", "tool"
///     friction = 0.6                       # Coulomb, against the glove
///     toss_apex_m = [0.1, 0.2]             # range of toss heights; default: never thrown
///
///     tracked_m = [0, 0, 0.4]              # point whose state is tracked; default: centre of mass
///
///     [ball]                               # instead: a thin hollow sphere bounced on the object,
///     radius_m = 0.02                      # whose state is tracked
///     mass_kg = 0.0027
///     drag_coefficient = 0.45
///     restitution = 0.8                    # against the object
///     friction = 0.6                       # against the object
///     face_center_m = [0, 0, 0.1]          # centre of the object's face, on the side of from_palm
///     color = [0.9, 0.4, 0.1]
///
///     [[solid]]                            # for contact and rendering
///     shape = "cylinder"                   # "capsule", "sphere", "box"
///     radius_m = 0.01                      # except box: half_size_m = [x, y, z]
///     half_length_m = 0.1                  # of the cylinder, or of a capsule's straight part
///     axis = [0, 0, 1]                     # direction of the shape's z axis, shortest rotation
///     center_m = [0, 0, 0]
///     color = [0.8, 0.6, 0.3]              # linear RGB, 0 to 1
///     mass_kg = 0.1                        # or density_kg_per_m3; homogeneous,
///     wall_m = 0.002                       # or, if given, only a wall of that thickness
///
///     [[filling]]                          # like [[solid]] without colour: mass only
///
///     [body]                               # measured mass properties instead of all masses above
///     mass_kg = 0.3
///     center_m = [0, 0, 0.02]
///     inertia_kg_m2 = [1e-4, 1e-4, 2e-5, 0, 0, 0]  # xx yy zz xy xz yz about the centre of mass
///
///     [hold]
///     center_m = [0, 0, 0]                 # point over the palm's centre
///     across = [0, 1, 0]                   # direction towards the little finger
///     from_palm = [0, 0, 1]                # direction out of the palm
///     turns = "none"                       # random rotation of each grasp: "axis" about `across`,
///                                          # "faces" by right angles, "any"
///
/// The file's origin is arbitrary. The returned body frame has its origin in the centre of mass.
/// `where` names the file in messages.
ObjectSpec parse_object(const std::string& name, const std::string& text, const std::string& where);

/// Reads a file; the object's name is the file's stem. Also throws data_error if the file cannot be
/// read or its stem is not of a-z, 0-9, - and _.
ObjectSpec read_object(const std::filesystem::path& file);

/// Returns a built-in object by name, or reads a file whose path ends with ".toml".
ObjectSpec load_object(const std::string& name_or_file);

}  // namespace touchtrace::scene
