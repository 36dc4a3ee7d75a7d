#include "pipeline/label/states/lost_clips.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/label/states/summary.h"
#include "pipeline/label/track/box_centre.h"

namespace touchtrace::label {
namespace {

constexpr double min_proposed_s = 2.0;  // of a clip to be cut out

/// Longest time in which `is_found(frame)`; nullopt if it is short.
template <class IsFound>
std::optional<std::pair<double, double>> longest_found_s(const ClipTrack& track, IsFound is_found) {
  std::size_t first = 0, longest = 0;
  for (std::size_t i = 0, count = 0; i < track.time_s.size(); ++i) {
    count = is_found(i) ? count + 1 : 0;
    if (count > longest) first = i + 1 - count, longest = count;
  }
  if (longest < 2) return std::nullopt;
  const std::pair times{track.time_s[first], track.time_s[first + longest - 1]};
  return times.second - times.first < min_proposed_s ? std::nullopt : std::optional(times);
}

/// What helps, with the longest times in which both bodies, or one of them, were found.
std::string remedy(const ClipTrack& track, bool has_mask_boxes) {
  const std::string boxes =
      has_mask_boxes ? "check the masks, or draw boxes (`touchtrace mark`)"
                     : "draw boxes in a frame that shows both better (`touchtrace mark`)";
  const auto are_both = [&](std::size_t i) { return track.hand[i].found && track.object[i].found; };
  if (const auto times = longest_found_s(track, are_both))
    return fmt::format(
        "both are found longest from {:.2f} to {:.2f} s: cut the clip there (`import --clips`), or "
        "{}",
        times->first, times->second, boxes);
  for (const auto& [body, observations] :
       {std::pair{"object", &track.object}, {"hand", &track.hand}})
    if (const auto times =
            longest_found_s(track, [&](std::size_t i) { return (*observations)[i].found; }))
      return fmt::format("the {} alone is found from {:.2f} to {:.2f} s; {}", body, times->first,
                         times->second, boxes);
  return boxes;
}

/// Drops the observations of bodies that were mostly lost, and says which. An object that moves
/// with a hand that was lost is lost, too.
std::vector<std::string> drop_lost_bodies(ClipTrack& track) {
  std::vector<std::string> lost;
  const auto drop_if_lost = [&](const char* body, std::vector<Observation>& observations) {
    const double fraction = lost_fraction(observations);
    if (!(fraction > 1.0 - min_found_fraction)) return;
    lost.push_back(fmt::format("{} lost in {:.0f} %", body, 100.0 * fraction));
    observations.assign(observations.size(), {});
  };
  drop_if_lost("hand", track.hand);
  if (!lost.empty())
    for (auto& object : track.object)
      if (object.follows_hand) object = {};
  drop_if_lost("object", track.object);
  return lost;
}

std::string lost_problem(const std::vector<std::string>& lost, const std::string& remedy) {
  const bool is_hand_lost = lost.front().starts_with("hand");
  return fmt::format(
      "{} of the camera frames{}{}; {}; check the calibration, that the camera does not move, and "
      "that no background image, if there are any, shows a person",
      fmt::join(lost, ", "),
      is_hand_lost ? " (also where it cannot be told from a bare arm: masks or a sleeve help)" : "",
      lost.size() == 1 ? ": all labels of that body are flagged as lost" : "", remedy);
}

std::string unsmoothed_problem(const char* body, SmoothStatus status) {
  return fmt::format(
      "the measured positions of the {} do not fit a smooth motion ({}): another body may have "
      "been taken for it; look at them with --preview, draw boxes in another frame, or cut the "
      "clip (`import --clips`)",
      body, name_of(status));
}

void warn_of_hidden_object(std::size_t clip, const ClipTrack& track) {
  const auto hidden = std::ranges::count(track.object, true, &Observation::follows_hand);
  const double fraction =
      static_cast<double>(hidden) / std::max(1.0, static_cast<double>(track.object.size()));
  if (fraction > 1.0 - min_found_fraction)
    Progress::warn(
        fmt::format("clip {}: the hand hides the object in {:.0f} % of the camera frames: its "
                    "labels are flagged there; if images show it, draw boxes in one that does "
                    "(`touchtrace mark`)",
                    clip, 100.0 * fraction));
}

}  // namespace

void drop_lost_clips(std::vector<ClipFrames>& clips, std::vector<ClipTrack>& tracks) {
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (!clips[i].is_usable()) continue;
    const auto advice = remedy(tracks[i], clips[i].has_mask_boxes);
    const auto lost = drop_lost_bodies(tracks[i]);
    if (lost.empty()) {
      warn_of_hidden_object(i, tracks[i]);
      continue;
    }
    const auto problem = lost_problem(lost, advice);
    if (lost.size() == 1) {
      Progress::warn(fmt::format("clip {}: {}", i, problem));
      continue;
    }
    clips[i].problem = problem;
    tracks[i] = {};
  }
}

void drop_objects_outside_boxes(const Camera& color, const std::vector<ClipFrames>& clips,
                                std::vector<ClipTrack>& tracks) {
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (!is_outside_box(color, clips[i], tracks[i])) continue;
    Progress::warn(fmt::format(
        "clip {}: the object's centre is found outside its box: all its labels are flagged as "
        "lost; other things may have its colours: give masks (`import --masks`)",
        i));
    tracks[i].object.assign(tracks[i].object.size(), {});
  }
}

void drop_unsmoothed_clips(std::vector<ClipFrames>& clips, std::vector<ClipTrack>& tracks,
                           SmoothedBodies& bodies) {
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (!clips[i].is_usable()) continue;
    for (const auto& [name, smoothed] :
         {std::pair{"hand", &bodies.hand}, {"object", &bodies.object}})
      if (const auto status = smoothed->tracks[i].status;
          status != SmoothStatus::converged && status != SmoothStatus::no_samples)
        clips[i].problem = unsmoothed_problem(name, status);
    if (clips[i].is_usable()) continue;
    tracks[i] = {};
    bodies.hand.tracks[i] = bodies.object.tracks[i] = {};
  }
}

void require_usable_clip(const std::vector<ClipFrames>& clips) {
  if (std::ranges::any_of(clips, &ClipFrames::is_usable)) return;
  const auto faulty =
      std::ranges::find_if(clips, [](const ClipFrames& c) { return !c.problem.empty(); });
  throw data_error(
      faulty == clips.end() ? std::string("no clip has camera frames")
                            : fmt::format("no clip can be labelled; clip {}: {}",
                                          faulty - clips.begin(), faulty->problem),
      faulty != clips.end() && faulty->has_mask_boxes
          ? "run: touchtrace check RECORDING; check the masks and, of `import`, "
            "--hand-id and --object-id"
          : "run: touchtrace check RECORDING; draw boxes by: touchtrace mark RECORDING");
}

}  // namespace touchtrace::label
