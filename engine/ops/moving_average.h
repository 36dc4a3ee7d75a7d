#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// Sets average += rate (values - average). Set `rate` before each launch (moving_average_rate()).
Launch moving_average(Runtime& runtime, const Buffer<float>& values, const Buffer<float>& average);
/// Rate of update number `count`, from 1: 1 / count up to `length`, then 1 / length. The average is
/// the mean of the first `length` values, then exponential (Polyak averaging).
void set_moving_average_rate(Launch& launch, int count, int length);

}  // namespace touchtrace
