#include "engine/train/tuning_json.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

using nlohmann::json;

constexpr int largest_number = 1 << 20;

template <class Struct>
using Number = std::pair<const char*, int Struct::*>;

constexpr std::array<Number<Conv2dShape>, 7> shape_numbers{
    {{"images", &Conv2dShape::images},
     {"in_channels", &Conv2dShape::in_channels},
     {"rows", &Conv2dShape::rows},
     {"cols", &Conv2dShape::cols},
     {"out_channels", &Conv2dShape::out_channels},
     {"kernel", &Conv2dShape::kernel},
     {"stride", &Conv2dShape::stride}}};
constexpr std::array<Number<Conv2dChoice>, 5> choice_numbers{
    {{"accumulators", &Conv2dChoice::accumulators},
     {"group_images", &Conv2dChoice::group_images},
     {"item_tiles", &Conv2dChoice::item_tiles},
     {"gradient_images", &Conv2dChoice::gradient_images},
     {"gradient_chunks", &Conv2dChoice::gradient_chunks}}};
constexpr std::array<std::pair<const char*, Conv2dMethod>, 2> methods{
    {{"direct", Conv2dMethod::direct}, {"winograd", Conv2dMethod::winograd}}};

Error damaged(const char* name) {
  return data_error(fmt::format("a tuned choice has no valid '{}'", name),
                    "touchtrace tune makes it anew");
}

int number_from(const json& row, const char* name) {
  const auto& value = row.at(name);
  if (!value.is_number_integer() || value < 1 || value > largest_number) throw damaged(name);
  return value.get<int>();
}

double time_from(const json& row, const char* name) {
  const auto value = row.at(name).get<double>();
  if (!(value >= 0.0)) throw damaged(name);
  return value;
}

void add_shape(json& row, const Conv2dShape& shape) {
  for (const auto& [name, number] : shape_numbers) row[name] = shape.*number;
  row["in_planes"] = shape.in_planes;
}

Conv2dShape shape_from(const json& row) {
  Conv2dShape shape{};
  for (const auto& [name, number] : shape_numbers) shape.*number = number_from(row, name);
  shape.in_planes = row.at("in_planes").get<bool>();
  return shape;
}

void add_times(json& row, const TunedTimes& times) {
  row["usual_ms"] = times.usual_ms, row["chosen_ms"] = times.chosen_ms;
}

TunedTimes times_from(const json& row) {
  return {time_from(row, "usual_ms"), time_from(row, "chosen_ms")};
}

json layer_json(const Tuning::Layer& layer) {
  json row;
  add_shape(row, layer.shape);
  add_times(row, layer.times);
  for (const auto& [name, method] : methods)
    if (layer.choice.method == method) row["method"] = name;
  for (const auto& [name, number] : choice_numbers)
    if (layer.choice.*number > 0) row[name] = layer.choice.*number;
  return row;
}

Tuning::Layer layer_from(const json& row) {
  Tuning::Layer layer{shape_from(row), {}, times_from(row)};
  for (const auto& [name, number] : choice_numbers)
    if (row.contains(name)) layer.choice.*number = number_from(row, name);
  for (const auto& [name, method] : methods)
    if (row.at("method") == name) return layer.choice.method = method, layer;
  throw damaged("method");
}

json part_json(const Tuning::Part& part) {
  json row;
  add_shape(row, part.first_layer);
  add_times(row, part.times);
  row["part_images"] = part.images;
  return row;
}

Tuning::Part part_from(const json& row) {
  return {shape_from(row), number_from(row, "part_images"), times_from(row)};
}

}  // namespace

std::string describe(const Conv2dChoice& choice) {
  std::string text;
  for (const auto& [name, method] : methods)
    if (choice.method == method) text = name;
  for (const auto& [name, number] : choice_numbers)
    if (choice.*number > 0) text += fmt::format(", {} {}", name, choice.*number);
  std::ranges::replace(text, '_', ' ');
  return text;
}

void to_json(json& document, const Tuning& tuning) {
  document = {{"layers", json::array()}, {"parts", json::array()}};
  for (const auto& layer : tuning.layers) document["layers"].push_back(layer_json(layer));
  for (const auto& part : tuning.parts) document["parts"].push_back(part_json(part));
}

void from_json(const json& document, Tuning& tuning) {
  tuning = {};
  for (const auto& row : document.at("layers")) tuning.layers.push_back(layer_from(row));
  for (const auto& row : document.at("parts")) tuning.parts.push_back(part_from(row));
}

}  // namespace touchtrace
