#pragma once

#include <filesystem>
#include <vector>

#include "engine/train/trainer.h"
#include "pipeline/study/model_card.h"

namespace touchtrace::study {

/// Where a run stands beside its weights: what the log needs to go on.
struct TrainingPosition {
  std::vector<TrainingLogEntry> log;
  double seconds = 0.0;   ///< spent on updates
  double loss_sum = 0.0;  ///< since the last entry
  int loss_count = 0;
};

/// The checkpoint of an unfinished run, one file beside the output that is whole at any moment, and
/// the best weights so far in another.
class Checkpoint {
 public:
  explicit Checkpoint(const std::filesystem::path& output);

  bool exists() const;
  /// `identity`: what must be the same for a run to go on.
  void save(const Trainer& trainer, const TrainingPosition& position,
            const nlohmann::json& identity) const;
  /// Throws data_error if there is none or it is of a run with another identity.
  TrainingPosition load(Trainer& trainer, const nlohmann::json& identity) const;
  const std::filesystem::path& path() const { return weights_; }
  /// Where the weights lie that did best on the validation clips. Those of a run that was killed
  /// may come from after its last checkpoint: going on makes them again before they are asked for.
  const std::filesystem::path& best() const { return best_; }
  void remove() const noexcept;

 private:
  std::filesystem::path weights_, best_;
};

}  // namespace touchtrace::study
