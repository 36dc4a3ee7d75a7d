#pragma once

#include <optional>
#include <string>
#include <vector>

namespace touchtrace {

/// Unit of the stamps of one clock.
struct StampUnit {
  std::string name;         ///< "milliseconds"
  double per_second = 1.0;  ///< stamps per second
};

/// Frames per unit of the stamps: those of the median interval between different stamps; 0 for
/// fewer than two.
double frames_per_stamp(std::vector<double> stamps);

/// Unit of all stamps of a file. Inferred from the magnitude of Unix times; otherwise,
/// or if that gives an implausible rate, it is the first of seconds, milliseconds,
/// microseconds and nanoseconds that gives a rate from `min_rate_hz` to 1000 Hz. Returns nullopt if
/// none does.
std::optional<StampUnit> stamp_unit(const std::vector<double>& stamps, double min_rate_hz);

/// Seconds of all stamps of a camera. Reports a unit other than seconds. Stamps with an implausible
/// rate in every unit stay as they are. `source`: of the stamps, for messages.
std::vector<double> in_seconds(std::vector<double> stamps, const std::string& source);

}  // namespace touchtrace
