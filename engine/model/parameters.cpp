#include "engine/model/parameters.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/integer_math.h"
#include "engine/base/random.h"

namespace touchtrace {
namespace {

constexpr std::size_t alignment = 16;

std::size_t aligned(std::size_t size) { return round_up(size, alignment); }

}  // namespace

Parameter ParameterTable::add(std::string name, std::vector<int> shape, Initial initial) {
  if (std::ranges::find(rows_, name, &Parameter::name) != rows_.end())
    throw failure(fmt::format("duplicate parameter '{}'", name), "report this as a bug");
  const auto size =
      std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
  rows_.push_back({std::move(name), std::move(shape), size_, size, initial});
  size_ += aligned(size);
  return rows_.back();
}

const Parameter& ParameterTable::at(std::string_view name) const {
  const auto found = std::ranges::find(rows_, name, &Parameter::name);
  if (found == rows_.end())
    throw failure(fmt::format("unknown parameter '{}'", name), "report this as a bug");
  return *found;
}

std::vector<float> ParameterTable::initial_values(std::uint64_t seed) const {
  std::vector<float> values(size_, 0.0f);
  for (const auto& row : rows_) {
    RandomStream random(seed, "initial " + row.name);
    const auto [centre, half_range] = row.initial;
    std::generate_n(values.begin() + static_cast<std::ptrdiff_t>(row.offset), row.size, [&] {
      return static_cast<float>(random.uniform(centre - half_range, centre + half_range));
    });
  }
  return values;
}

}  // namespace touchtrace
