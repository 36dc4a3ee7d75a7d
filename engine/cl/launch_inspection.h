#pragma once

#include <functional>
#include <string>

#include "engine/cl/launch.h"

namespace touchtrace {

/// Runs `pass` and calls `visit` after each launch that it enqueues, when the launch has completed.
void visit_launches(Runtime& runtime, const std::function<void()>& pass,
                    const std::function<void(const Launch&)>& visit);

/// Name of the first kernel of `pass` that computes a NaN or an infinity from finite values; empty
/// if none does. For diagnosing a failure: runs the pass twice, and sets non-finite values in its
/// buffers to zero before the second run.
std::string first_non_finite_kernel(Runtime& runtime, const std::function<void()>& pass);

}  // namespace touchtrace
