#pragma once

#include <filesystem>
#include <vector>

#include "engine/train/trainer.h"
#include "pipeline/study/model_card.h"

namespace touchtrace::study {

/// State of a run besides its weights and optimiser.
struct TrainingPosition {
  std::vector<TrainingLogEntry> log;
  double seconds = 0.0;   ///< spent on updates
  double loss_sum = 0.0;  ///< since the last log entry
  int loss_count = 0;
  std::vector<Tensor> best;  ///< weights that are best on the validation clips; empty: none yet
};

/// Checkpoint of an unfinished run next to its output, replaced atomically.
class Checkpoint {
 public:
  explicit Checkpoint(const std::filesystem::path& output);

  bool exists() const;
  /// `identity`: options and inputs that a resumed run must share.
  void save(const Trainer& trainer, const TrainingPosition& position,
            const nlohmann::json& identity) const;
  /// Throws data_error if there is no checkpoint, or one with another identity.
  TrainingPosition load(Trainer& trainer, const nlohmann::json& identity) const;
  const std::filesystem::path& path() const { return path_; }
  void remove() const noexcept;

 private:
  std::filesystem::path path_;
};

}  // namespace touchtrace::study
