#pragma once

#include <functional>
#include <string>

#include "engine/cl/launch.h"

namespace touchtrace {

/// Runs `pass` and calls `visit` after each launch that it queues.
void visit_launches(Runtime& runtime, const std::function<void()>& pass,
                    const std::function<void(const Launch&)>& visit);

/// Names the first launch of `pass` that makes a NaN or an infinity out of finite values; empty if
/// none does. Runs the pass twice, and zeros what is not finite in its arrays before: for looking
/// into a failure, not for every step.
std::string first_not_finite(Runtime& runtime, const std::function<void()>& pass);

}  // namespace touchtrace
