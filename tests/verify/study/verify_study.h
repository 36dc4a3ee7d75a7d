#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace::study {

/// Measures training and evaluation on the synthetic data set, on the fastest device: rows of
/// `touchtrace-verify study`.
Verification verify_study();

}  // namespace touchtrace::study
