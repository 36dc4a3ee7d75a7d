#pragma once

#include <filesystem>

#include "pipeline/scene/objects/object.h"

namespace touchtrace::scene {

/// An object as its TOML file describes it (pipeline/scene/objects/*.toml; format below). The file
/// may hold anything: throws data_error for what is no object that physics can hold.
///
///     summary = "a hammer"                 # one line
///     role = "seen"                        # "unseen", "outside", "tool"
///     friction = 0.6                       # against the glove, Coulomb
///     toss_apex_m = [0.1, 0.2]             # tosses rise that far; left out: never thrown
///
///     tracked_m = [0, 0, 0.4]              # its state is that of this point (default: of its
///                                          # centre of mass), or of a ball:
///     [ball]                               # a thin hollow sphere that is bounced on it
///     radius_m = 0.02
///     mass_kg = 0.0027
///     drag_coefficient = 0.45
///     restitution = 0.8                    # against the object, like
///     friction = 0.6
///     meets_m = [0, 0, 0.1]                # the middle of the object's face, out of the palm
///     color = [0.9, 0.4, 0.1]
///
///     [[solid]]                            # felt and seen
///     shape = "cylinder"                   # "capsule", "sphere", "box"
///     radius_m = 0.01                      # of all but the box: half_size_m = [x, y, z]
///     half_length_m = 0.1                  # of the cylinder, and of a capsule's straight part
///     axis = [0, 0, 1]                     # of the shape's z, turned there the short way
///     center_m = [0, 0, 0]
///     color = [0.8, 0.6, 0.3]              # linear RGB, 0 to 1
///     mass_kg = 0.1                        # or density_kg_per_m3; evenly spread,
///     wall_m = 0.002                       # in a wall that thick where there is one
///
///     [[filling]]                          # the same without colour: neither felt nor seen
///
///     [body]                               # instead of all masses above, where they were measured
///     mass_kg = 0.3
///     center_m = [0, 0, 0.02]
///     inertia_kg_m2 = [1e-4, 1e-4, 2e-5, 0, 0, 0]  # xx yy zz xy xz yz about the centre of mass
///
///     [hold]
///     center_m = [0, 0, 0]                 # lies over the middle of the palm
///     across = [0, 1, 0]                   # towards the little finger
///     from_palm = [0, 0, 1]                # out of the palm
///     turns = "none"                       # "axis": every grasp another way round about `across`;
///                                          # "faces": on any face, "any": at will
///
/// The file's origin is anywhere; the body's is its centre of mass. The object has the file's name.
ObjectSpec parse_object(const std::string& name, const std::string& text, const std::string& where);

/// Throws data_error, too, for a file that cannot be read, or a name not of a-z, 0-9, - and _.
ObjectSpec read_object(const std::filesystem::path& file);

/// One that comes with the program by its name, or a file by its path, which ends with ".toml".
ObjectSpec object_of(const std::string& name_or_file);

}  // namespace touchtrace::scene
