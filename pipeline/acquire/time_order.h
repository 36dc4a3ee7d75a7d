#pragma once

#include <string>
#include <utility>
#include <vector>

namespace touchtrace {

/// Indices of images in the order of their time stamps. Warns of stamps that run backward: how many
/// and the first one. Throws data_error if the clock was set back, so that sorting would mix images
/// from before and after it, and for stamps that are not finite. `source`: of the stamps, for
/// messages.
std::vector<std::size_t> time_order(const std::vector<double>& time_s, const std::string& source);

/// `items` in the order of their member `time_s`; see time_order().
template <class Item>
std::vector<Item> in_time_order(std::vector<Item> items, double Item::*time_s,
                                const std::string& source) {
  std::vector<double> times_s;
  for (const Item& item : items) times_s.push_back(item.*time_s);
  std::vector<Item> ordered;
  for (const std::size_t i : time_order(times_s, source)) ordered.push_back(std::move(items[i]));
  return ordered;
}

}  // namespace touchtrace
