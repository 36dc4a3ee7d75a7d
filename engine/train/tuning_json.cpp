#include "engine/train/tuning_json.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

using nlohmann::json;

constexpr int max_number = 1 << 20;

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

Error invalid(const char* key) {
  return data_error(fmt::format("tuning has no valid '{}'", key), "run touchtrace tune again");
}

/// Value of a key, or of the name that it had in older files.
const json& at(const json& row, const char* key, const char* old_key) {
  return row.at(row.contains(key) ? key : old_key);
}

int number_in(const json& value, const char* key) {
  if (!value.is_number_integer() || value < 1 || value > max_number) throw invalid(key);
  return value.get<int>();
}

double time_in(const json& value, const char* key) {
  const auto ms = value.get<double>();
  if (!(ms >= 0.0)) throw invalid(key);
  return ms;
}

void add_shape(json& row, const Conv2dShape& shape) {
  for (const auto& [name, number] : shape_numbers) row[name] = shape.*number;
  row["in_planes"] = shape.in_planes;
}

Conv2dShape shape_from(const json& row) {
  Conv2dShape shape{};
  for (const auto& [name, number] : shape_numbers) shape.*number = number_in(row.at(name), name);
  shape.in_planes = row.at("in_planes").get<bool>();
  return shape;
}

void add_times(json& row, const TunedTimes& times) {
  row["default_ms"] = times.default_ms, row["tuned_ms"] = times.tuned_ms;
}

TunedTimes times_from(const json& row) {
  return {time_in(at(row, "default_ms", "usual_ms"), "default_ms"),
          time_in(at(row, "tuned_ms", "chosen_ms"), "tuned_ms")};
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
    if (row.contains(name)) layer.choice.*number = number_in(row.at(name), name);
  for (const auto& [name, method] : methods)
    if (row.at("method") == name) return layer.choice.method = method, layer;
  throw invalid("method");
}

json micro_batch_json(const Tuning::MicroBatch& batch) {
  json row;
  add_shape(row, batch.first_layer);
  add_times(row, batch.times);
  row["micro_batch_images"] = batch.images;
  return row;
}

Tuning::MicroBatch micro_batch_from(const json& row) {
  constexpr const char* key = "micro_batch_images";
  return {shape_from(row), number_in(at(row, key, "part_images"), key), times_from(row)};
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
  document = {{"layers", json::array()}, {"micro_batches", json::array()}};
  for (const auto& layer : tuning.layers) document["layers"].push_back(layer_json(layer));
  for (const auto& batch : tuning.micro_batches)
    document["micro_batches"].push_back(micro_batch_json(batch));
}

void from_json(const json& document, Tuning& tuning) {
  tuning = {};
  for (const auto& row : document.at("layers")) tuning.layers.push_back(layer_from(row));
  for (const auto& row : at(document, "micro_batches", "parts"))
    tuning.micro_batches.push_back(micro_batch_from(row));
}

}  // namespace touchtrace
