#include "pipeline/cli/update_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

namespace touchtrace::cli {
namespace {

const PlannedLaunch& planned(const PlannedLaunch& launch) { return launch; }
const PlannedLaunch& planned(const MeasuredLaunch& launch) { return launch.planned; }

/// Sum over launches with a common key; kernel and purpose are those of the first.
struct LaunchSum {
  std::string kernel;
  Purpose purpose;
  int launches = 0;
  LaunchCost cost{};
  double seconds = 0.0, seconds_in_place = 0.0;

  void add(const PlannedLaunch& launch) {
    ++launches;
    cost.flops += launch.cost.flops, cost.bytes += launch.cost.bytes;
  }
  void add(const MeasuredLaunch& launch) {
    add(launch.planned);
    seconds += launch.seconds, seconds_in_place += launch.seconds_in_place;
  }
};

/// Sums launches by key, in the order of first use.
template <class SomeLaunch, class KeyOf>
std::vector<LaunchSum> sums_by(const std::vector<SomeLaunch>& launches, KeyOf key_of) {
  std::vector<LaunchSum> sums;
  std::vector<decltype(key_of(planned(launches[0])))> keys;
  for (const auto& launch : launches) {
    const auto& [kernel, purpose, cost] = planned(launch);
    const auto key = key_of(planned(launch));
    const auto found = static_cast<std::size_t>(std::ranges::find(keys, key) - keys.begin());
    if (found == keys.size()) keys.push_back(key), sums.push_back({kernel, purpose});
    sums[found].add(launch);
  }
  return sums;
}

template <class SomeLaunch>
LaunchSum sum_of(const std::vector<SomeLaunch>& launches) {
  return sums_by(launches, [](const PlannedLaunch&) { return 0; }).front();
}

std::vector<LaunchSum> sums_by_purpose(const MeasuredUpdate& update) {
  return sums_by(update.launches, [](const PlannedLaunch& launch) { return launch.purpose; });
}

std::string or_dash(double number, int decimals, double unit = 1.0) {
  return number > 0.0 ? fmt::format("{:.{}f}", number / unit, decimals) : "-";
}

void print_planned_row(const std::string& name, const LaunchSum& sum) {
  fmt::print("  {:<28} {:>9} {:>10} {:>9.1f}\n", name, sum.launches,
             or_dash(sum.cost.flops, 2, 1e6), sum.cost.bytes / (1 << 20));
}

void print_measured_head(const char* first, const char* second) {
  fmt::print("  {:<24} {:<16} {:>8} {:>8} {:>8} {:>7} {:>6} {:>5} {:>6} {:>8}\n", first, second,
             "launches", "MFLOP", "us each", "ms", "share", "peak", "GB/s", "in place");
}

/// `all`: sum over all launches.
void print_measured_row(const std::string& first, const std::string& second, const LaunchSum& sum,
                        const LaunchSum& all, double peak_flops) {
  fmt::print("  {:<24} {:<16} {:>8} {:>8} {:>8.1f} {:>7.3f} {:>6.3f} {:>5} {:>6.1f} {:>8.3f}\n",
             first, second, sum.launches, or_dash(sum.cost.flops, 2, 1e6),
             1e6 * sum.seconds / sum.launches, 1e3 * sum.seconds, sum.seconds / all.seconds,
             or_dash(sum.cost.flops / sum.seconds / peak_flops, 2),
             1e-9 * sum.cost.bytes / sum.seconds, 1e3 * sum.seconds_in_place);
}

nlohmann::json sum_json(const LaunchSum& sum, const LaunchSum& all, double peak_flops) {
  return {{"flops", sum.cost.flops},
          {"bytes", sum.cost.bytes},
          {"seconds", sum.seconds},
          {"seconds_in_place", sum.seconds_in_place},
          {"share", sum.seconds / all.seconds},
          {"share_of_peak", sum.cost.flops / sum.seconds / peak_flops},
          {"bytes_per_second", sum.cost.bytes / sum.seconds}};
}

nlohmann::json launch_json(const PlannedLaunch& launch) {
  return {{"kernel", launch.kernel},
          {"purpose", name_of(launch.purpose)},
          {"flops", launch.cost.flops},
          {"bytes", launch.cost.bytes}};
}

}  // namespace

void print_update(const std::vector<PlannedLaunch>& launches) {
  fmt::print("  {:<28} {:>9} {:>10} {:>9}\n", "kernel", "launches", "MFLOP", "MiB");
  for (const auto& sum :
       sums_by(launches, [](const PlannedLaunch& launch) { return launch.kernel; }))
    print_planned_row(sum.kernel, sum);
  print_planned_row("all", sum_of(launches));
}

nlohmann::json update_json(const std::vector<PlannedLaunch>& launches) {
  auto rows = nlohmann::json::array();
  for (const auto& launch : launches) rows.push_back(launch_json(launch));
  return {{"launches", rows}};
}

void print_update(const MeasuredUpdate& update) {
  const auto all = sum_of(update.launches);
  const auto print_row = [&](const std::string& first, const std::string& second,
                             const LaunchSum& sum) {
    print_measured_row(first, second, sum, all, update.peak_flops);
  };
  const auto shape = [](const PlannedLaunch& launch) {
    return std::tuple(launch.kernel, launch.purpose, launch.cost.flops, launch.cost.bytes);
  };
  print_measured_head("kernel", "purpose");
  for (const auto& sum : sums_by(update.launches, shape))
    print_row(sum.kernel, name_of(sum.purpose), sum);
  fmt::print("\n");
  print_measured_head("purpose", "");
  for (const auto& sum : sums_by_purpose(update)) print_row(name_of(sum.purpose), "", sum);
  print_row("all", "", all);
  fmt::print(
      "  whole update: {:.3f} ms of CPU time, {:.3f} ms of wall time\n"
      "  peak: {:.1f} GFLOP/s\n",
      1e3 * update.cpu_seconds, 1e3 * update.wall_seconds, 1e-9 * update.peak_flops);
}

nlohmann::json update_json(const MeasuredUpdate& update) {
  const auto all = sum_of(update.launches);
  auto launches = nlohmann::json::array(), purposes = nlohmann::json::array();
  for (const auto& launch : update.launches) {
    launches.push_back(launch_json(launch.planned));
    launches.back().update(sum_json(sum_of<MeasuredLaunch>({launch}), all, update.peak_flops));
  }
  for (const auto& sum : sums_by_purpose(update)) {
    purposes.push_back({{"purpose", name_of(sum.purpose)}, {"launches", sum.launches}});
    purposes.back().update(sum_json(sum, all, update.peak_flops));
  }
  return {{"launches", launches},
          {"purposes", purposes},
          {"update",
           {{"launch_seconds", all.seconds},
            {"launch_seconds_in_place", all.seconds_in_place},
            {"cpu_seconds", update.cpu_seconds},
            {"wall_seconds", update.wall_seconds},
            {"peak_flops", update.peak_flops}}}};
}

}  // namespace touchtrace::cli
