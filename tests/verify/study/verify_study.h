#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace::study {

/// Rows of `touchtrace-verify study`: training and evaluation on the synthetic data set, where
/// nothing but touch tells the force, on the fastest device.
Verification verify_study();

}  // namespace touchtrace::study
