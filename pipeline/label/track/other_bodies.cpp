#include "pipeline/label/track/other_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace touchtrace::label {
namespace {

constexpr int hand_owner = 0, no_owner = OwnedCells::no_owner, doubtful_owner = -2;
constexpr double infinite_m = std::numeric_limits<double>::infinity();
constexpr double min_cell_m = 0.015, cell_pixels = 3.0, cell_noise_sigmas = 3.0;
// Minimum visible area of an arm over that of a hand's disc. Smaller patches belong to the hand.
constexpr double min_arm_fraction = 0.5;
constexpr double established_s = 0.5;  // what vanishes earlier was noise
// Elbow to fingertip, 95th percentile of men in ANSUR II (Gordon et al. 2014).
constexpr double forearm_hand_m = 0.52;
const double min_log_ratio = std::log(20.0);

}  // namespace

void OtherBodies::start(const Surface& surface, const PixelBox& hand_box,
                        const PixelBox& object_box, const Patch& hand) {
  bodies_.assign(1, {});
  bodies_.front().centroid_m = hand.centroid_m;
  find_cells(surface);
  const auto is_inside = [&](const PixelBox& box, const Cell& cell) {
    const auto inside = std::ranges::count_if(
        cell.points, [&](std::size_t point) { return contains(box, surface[point]); });
    return 2 * static_cast<std::size_t>(inside) >= cell.points.size();
  };
  for (std::size_t i = 0; i < owned_.cells.size(); ++i)
    if (is_inside(hand_box, owned_.cells[i]))
      owned_.owners[i] = hand_owner;
    else if (is_inside(object_box, owned_.cells[i]))
      owned_.owners[i] = doubtful_owner;  // fingers or the object
  // The hand and another one that holds the object, too, are connected by what is in its box.
  const auto of_hand = owned_.of(hand_owner);
  for (const auto& part : owned_.parts_of(no_owner))
    if (owned_.visible_fraction(part) >=
        (owned_.touch(part, of_hand) ? min_arm_fraction : min_hand_fraction))
      add_body(part);
  owned_.give_to_nearest(doubtful_owner);
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const auto cells = owned_.of(static_cast<int>(k));
    bodies_[k].measure(owned_, cells, k == hand_owner ? hand.centroid_m : owned_.centroid_m(cells),
                       seconds_);
  }
}

void OtherBodies::exclude_from(Surface& surface, double seconds) {
  seconds_ = seconds;
  const auto was_noise = [](const TrackedBody& body) {
    return !body.is_visible && body.seen_s < established_s;
  };
  bodies_.erase(std::remove_if(bodies_.begin() + 1, bodies_.end(), was_noise), bodies_.end());
  for (auto& body : bodies_) body.filter.predict(seconds, false, Eigen::Vector3d::Zero());
  find_cells(surface);
  assign_to_visible();
  for (std::size_t i = 1, count = bodies_.size(); i < count; ++i) release_distant(i);
  assign_to_hidden();
  measure_others();
  for (std::size_t i = 0; i < owned_.cells.size(); ++i)
    if (owned_.owners[i] != hand_owner && owned_.owners[i] != no_owner)
      for (const auto point : owned_.cells[i].points) surface[point].body = Body::rest;
}

/// Cells as wide as pixels and depth noise require at the hand's distance.
void OtherBodies::find_cells(const Surface& surface) {
  const double z = bodies_.front().centroid_m.z();
  const double width_m =
      std::max({min_cell_m, cell_pixels * segmenter_.pixel_angular_size_rad() * z,
                cell_noise_sigmas * depth_noise_at_1m_ * z * z});
  owned_.find(surface, static_cast<float>(width_m), bodies_.front().centroid_m, 2.0 * arm_reach_m);
}

/// Owners of cells by visible bodies' surfaces, moved as their filters predict. Bodies that touch
/// are moved together: where a component is divided between them is not known, and neither are
/// their velocities.
void OtherBodies::assign_to_visible() {
  for (auto& body : bodies_) body.shift_m = body.expected_m() - body.centroid_m;
  assign_to_nearest();
  const auto groups = owned_.touching();
  if (groups.empty()) return;
  for (const auto& group : groups) {
    Eigen::Vector3d before_m = Eigen::Vector3d::Zero(), after_m = Eigen::Vector3d::Zero();
    double num_before = 0.0, num_after = 0.0;
    for (const auto k : group) {
      before_m += bodies_[k].surface_m.matrix().cast<double>().colwise().sum().transpose();
      num_before += static_cast<double>(bodies_[k].surface_m.rows());
      for (const auto i : owned_.of(static_cast<int>(k)))
        after_m += owned_.cells[i].mean_m.cast<double>(), num_after += 1.0;
    }
    for (const auto k : group) bodies_[k].shift_m = after_m / num_after - before_m / num_before;
  }
  owned_.owners.assign(owned_.cells.size(), no_owner);
  assign_to_nearest();
}

/// Owner of each cell: the nearest visible body, within the filter's gate.
void OtherBodies::assign_to_nearest() {
  std::vector<std::vector<double>> distances_m;  // [bodies, cells]
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    auto& row = distances_m.emplace_back(owned_.cells.size(), infinite_m);
    if (!bodies_[k].is_visible) continue;
    for (std::size_t i = 0; i < owned_.cells.size(); ++i) {
      row[i] = bodies_[k].distance_m(owned_.cells[i].mean_m);
      const auto owner = static_cast<std::size_t>(std::max(0, owned_.owners[i]));
      if (row[i] < bodies_[k].filter.gate_m() &&
          (owned_.owners[i] == no_owner || row[i] < distances_m[owner][i]))
        owned_.owners[i] = static_cast<int>(k);
    }
  }
  share_components(distances_m);
}

/// A component belongs to the body that has most cells in it and to the bodies that have no more
/// cells in another component: to the nearest of those.
void OtherBodies::share_components(const std::vector<std::vector<double>>& distances_m) {
  using Component = std::size_t;
  using Owner = std::size_t;
  std::map<Component, std::map<Owner, std::size_t>> votes;
  for (std::size_t i = 0; i < owned_.cells.size(); ++i)
    if (owned_.owners[i] != no_owner)
      ++votes[owned_.cells[i].component][static_cast<Owner>(owned_.owners[i])];
  std::map<Owner, std::pair<std::size_t, Component>> largest;  // of each body
  for (const auto& [component, counts] : votes)
    for (const auto& [owner, count] : counts)
      largest[owner] = std::max(largest[owner], {count, component});
  std::map<Component, std::vector<Owner>> sharers;
  for (const auto& [owner, main] : largest) sharers[main.second].push_back(owner);
  for (const auto& [component, counts] : votes)
    if (!sharers.contains(component))
      sharers[component] = {std::ranges::max_element(counts, {}, [](const auto& count) {
                              return count.second;
                            })->first};
  for (std::size_t i = 0; i < owned_.cells.size(); ++i)
    if (const auto found = sharers.find(owned_.cells[i].component); found != sharers.end())
      owned_.owners[i] = static_cast<int>(*std::ranges::min_element(
          found->second, {}, [&](Owner owner) { return distances_m[owner][i]; }));
}

/// Takes components from another body that are a hand's size away from its largest one. One that
/// may be the hidden hand is a new body if the other body may be the hand as well.
void OtherBodies::release_distant(std::size_t body) {
  const auto components = owned_.components_of(static_cast<int>(body));
  if (components.size() < 2) return;
  const auto main = std::ranges::max_element(components, {}, &CellIndices::size);
  for (const auto& component : components) {
    if (&component == &*main || owned_.touch(component, *main, hand_patch_radius_m)) continue;
    for (const auto i : component) owned_.owners[i] = no_owner;
    if (bodies_.front().is_visible || owned_.visible_fraction(component) < min_hand_fraction)
      continue;
    if (log_ratio(bodies_[body], owned_.place_of(*main), bodies_.front(),
                  owned_.place_of(component)) < min_log_ratio)
      add_body(component);
  }
}

void OtherBodies::assign_to_hidden() {
  for (const auto& component : owned_.components_of(no_owner)) {
    const int owner = hidden_owner(component);
    for (const auto i : component) owned_.owners[i] = owner;
  }
}

/// Hidden body that most likely moved to a component.
int OtherBodies::hidden_owner(const CellIndices& component) const {
  const bool is_hand_hidden = !bodies_.front().is_visible;
  if (owned_.visible_fraction(component) < min_hand_fraction)
    return is_hand_hidden ? hand_owner : no_owner;
  const auto place = owned_.place_of(component);
  std::vector<std::pair<double, int>> candidates;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const auto& body = bodies_[k];
    if (body.is_visible || (body.centroid_m - place.centroid_m).norm() > 2.0 * arm_reach_m)
      continue;
    candidates.emplace_back(body.misfit(place) + 3.0 * std::log(body.reach_m()),
                            static_cast<int>(k));
  }
  if (candidates.empty()) return no_owner;
  std::ranges::sort(candidates);
  const auto [best, owner] = candidates.front();
  const bool is_close = candidates.size() > 1 && candidates[1].first - best < min_log_ratio;
  const bool may_be_hand = owner == hand_owner || (is_close && candidates[1].second == hand_owner);
  return is_close && may_be_hand ? doubtful_owner : owner;
}

void OtherBodies::measure_others() {
  for (std::size_t k = 1; k < bodies_.size(); ++k) {
    const auto cells = owned_.of(static_cast<int>(k));
    if (owned_.visible_fraction(cells) >= min_hand_fraction)
      bodies_[k].measure(owned_, cells, owned_.centroid_m(cells), seconds_);
    else
      bodies_[k].is_visible = false;
  }
}

bool OtherBodies::update(const std::optional<Patch>& hand) {
  const auto before = bodies_.front();
  bodies_.front().is_visible = false;
  if (!hand) return true;
  const auto [own, apart] = hand_cells(*hand);
  if (own.empty()) return false;
  for (const auto& component : apart) {
    const auto* hidden = before.is_visible ? hidden_near(owned_.centroid_m(component)) : nullptr;
    if (!hidden || log_ratio(before, owned_.place_of(own), *hidden, owned_.place_of(component)) >=
                       min_log_ratio)
      continue;
    add_body(own);
    for (const auto& other : apart) add_body(other);
    return false;
  }
  bodies_.front().is_visible = before.is_visible;
  bodies_.front().measure(owned_, own, hand->centroid_m, seconds_);
  for (const auto& component : apart) {
    const auto position_m = owned_.centroid_m(component);
    if (auto* hidden = hidden_near(position_m))
      hidden->measure(owned_, component, position_m, seconds_);
    else
      add_body(component);
  }
  return true;
}

OtherBodies::HandCells OtherBodies::hand_cells(const Patch& hand) const {
  HandCells result;
  const auto distance_m = [&](std::size_t i) {
    return (owned_.cells[i].mean_m.cast<double>() - hand.centroid_m).norm();
  };
  for (const int owner : {hand_owner, no_owner})
    for (auto& component : owned_.components_of(owner)) {
      const auto arm_end = std::ranges::partition(
          component, [&](std::size_t i) { return distance_m(i) < forearm_hand_m; });
      CellIndices far(arm_end.begin(), arm_end.end());
      component.erase(arm_end.begin(), component.end());
      const bool is_own = std::ranges::any_of(
          component, [&](std::size_t i) { return distance_m(i) < hand_patch_radius_m; });
      result.apart.push_back(std::move(far));
      if (is_own)
        result.own.insert(result.own.end(), component.begin(), component.end());
      else
        result.apart.push_back(std::move(component));
    }
  std::erase_if(result.apart, [&](const CellIndices& component) {
    return owned_.visible_fraction(component) < min_hand_fraction;
  });
  return result;
}

TrackedBody* OtherBodies::hidden_near(const Eigen::Vector3d& position_m) {
  TrackedBody* nearest = nullptr;
  for (std::size_t k = 1; k < bodies_.size(); ++k) {
    auto& body = bodies_[k];
    const double distance_m = (body.centroid_m - position_m).norm();
    if (!body.is_visible && distance_m < body.reach_m() &&
        (!nearest || distance_m < (nearest->centroid_m - position_m).norm()))
      nearest = &body;
  }
  return nearest;
}

void OtherBodies::add_body(const CellIndices& cells) {
  for (const auto i : cells) owned_.owners[i] = static_cast<int>(bodies_.size());
  bodies_.emplace_back();
  bodies_.back().measure(owned_, cells, owned_.centroid_m(cells), seconds_);
}

}  // namespace touchtrace::label
