#pragma once

#include <vector>

#include "pipeline/study/comparison.h"

namespace touchtrace::study {

/// Assigns Split::evaluation to the clips to evaluate on: all clips of a recording of which no
/// model of its activity has seen any, else those that load_dataset assigned. Returns the names of
/// the sessions that are used whole. Throws data_error if a model was trained, validated or
/// calibrated on one of these clips, or if two recordings have touch or motion in common.
std::vector<std::string> choose_evaluation_clips(std::vector<Session>& sessions,
                                                 const std::vector<LoadedModel>& models);

}  // namespace touchtrace::study
