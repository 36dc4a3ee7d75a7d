#include "pipeline/study/evaluation_clips.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "pipeline/dataset/distinct_clips.h"
#include "pipeline/dataset/fingerprint.h"

namespace touchtrace::study {
namespace {

bool has_seen(const LoadedModel& model, const Sequence& clip) {
  return is_known_clip(clip.fingerprints, model.card.seen_clips);
}

/// Whether the models of the session's activity have seen a clip of it.
bool is_seen(const Session& session, const std::vector<LoadedModel>& models) {
  return std::ranges::any_of(models, [&](const LoadedModel& model) {
    return model.card.activity == session.data.activity &&
           std::ranges::any_of(session.data.sequences,
                               [&](const Sequence& clip) { return has_seen(model, clip); });
  });
}

void require_unseen(const Session& session, const LoadedModel& model) {
  for (const Sequence& clip : session.data.sequences)
    if (clip.split == Split::evaluation && has_seen(model, clip))
      throw data_error(fmt::format("{} was trained or tuned on clip {} of {}, an evaluation clip",
                                   model.path, clip.clip, session.name),
                       "evaluate it on other recordings, or train it again");
}

void require_distinct(const std::vector<Session>& sessions) {
  DistinctClips distinct;
  for (const Session& session : sessions) distinct.add(session.data.sequences, session.name);
}

}  // namespace

std::vector<std::string> choose_evaluation_clips(std::vector<Session>& sessions,
                                                 const std::vector<LoadedModel>& models) {
  require_distinct(sessions);
  std::vector<std::string> whole;
  for (Session& session : sessions) {
    if (!is_seen(session, models)) {
      for (Sequence& clip : session.data.sequences) clip.split = Split::evaluation;
      whole.push_back(session.name);
    }
    for (const LoadedModel& model : models) require_unseen(session, model);
  }
  return whole;
}

}  // namespace touchtrace::study
