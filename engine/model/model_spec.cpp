#include "engine/model/model_spec.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

using nlohmann::json;

/// An integer of a spec: min, min + step, ... max.
struct IntegerField {
  const char* key;
  int ModelSpec::*value;
  int min, max, step;
};

constexpr std::array<IntegerField, 8> integer_fields{{
    {"window_frames", &ModelSpec::window_frames, 1, 32, 1},
    {"rows", &ModelSpec::rows, 1, 64, 1},
    {"cols", &ModelSpec::cols, 1, 64, 1},
    {"tactile_kernel", &ModelSpec::tactile_kernel, 3, 5, 2},
    {"embedding", &ModelSpec::embedding, 16, 1024, 16},
    {"hidden", &ModelSpec::hidden, 64, 1024, 64},
    {"state", &ModelSpec::state, 1, 16, 1},
    {"segment_frames", &ModelSpec::segment_frames, 1, 32, 1},
}};
constexpr std::array optional_keys{"tactile_kernel", "segment_frames"};
constexpr const char *band_range = "a number between 0 and 0.5", *strides_range = "3 times 1 or 2",
                     *temperature_range = "a number in 0..100, 0 for dot products";

constexpr std::array<std::pair<const char*, ObjectEncoder>, 3> object_names{
    {{"none", ObjectEncoder::none},
     {"frozen", ObjectEncoder::frozen},
     {"joint", ObjectEncoder::joint}}};
constexpr std::array<std::pair<const char*, DynamicsKind>, 2> dynamics_names{
    {{"mlp", DynamicsKind::mlp}, {"gru", DynamicsKind::gru}}};

std::string out_of_range(const char* key, const std::string& value, const std::string& expected) {
  return fmt::format("model specification: '{}' is {}; expected {}", key, value, expected);
}

/// Names the type of arrays and objects instead of printing them: printing is recursive, and the
/// nesting of an untrusted file may exceed the stack.
Error rejected(const char* key, const json& value, const std::string& expected) {
  constexpr std::size_t max_shown = 40;
  std::string text = value.is_structured()
                         ? value.type_name()
                         : value.dump(-1, ' ', true, json::error_handler_t::replace);
  if (text.size() > max_shown) text = text.substr(0, max_shown) + "...";
  return data_error(out_of_range(key, text, expected), "use a model that touchtrace train wrote");
}

std::string range_of(const IntegerField& field) {
  auto text = fmt::format("an integer in {}..{}", field.min, field.max);
  if (field.step > 1) text += fmt::format(" in steps of {}", field.step);
  return text;
}

bool contains(const IntegerField& field, std::int64_t value) {
  return value >= field.min && value <= field.max && (value - field.min) % field.step == 0;
}

/// Also rejects integers that do not fit an int64.
bool is_integer(const json& value) {
  return value.is_number_integer() &&
         !(value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX);
}

template <class Enum, std::size_t N>
Enum parse(const json& value, const char* key,
           const std::array<std::pair<const char*, Enum>, N>& names) {
  std::string expected;
  for (const auto& [name, choice] : names) {
    if (value == name) return choice;
    expected += fmt::format("{}'{}'", expected.empty() ? "" : ", ", name);
  }
  throw rejected(key, value, "one of " + expected);
}

template <class Enum, std::size_t N>
const char* name_in(const std::array<std::pair<const char*, Enum>, N>& names, Enum value) {
  for (const auto& [name, choice] : names)
    if (choice == value) return name;
  return "";
}

/// Empty if the spec is valid.
std::optional<std::string> problem_of(const ModelSpec& spec) {
  for (const auto& field : integer_fields)
    if (!contains(field, spec.*field.value))
      return out_of_range(field.key, std::to_string(spec.*field.value), range_of(field));
  for (const int stride : spec.tactile_strides)
    if (stride != 1 && stride != 2)
      return out_of_range("tactile_strides", std::to_string(stride), strides_range);
  if (!(spec.band_quantile > 0.0 && spec.band_quantile < 0.5))
    return out_of_range("band_quantile", fmt::format("{}", spec.band_quantile), band_range);
  if (!(spec.contrast_temperature >= 0.0f && spec.contrast_temperature <= 100.0f))
    return out_of_range("contrast_temperature", fmt::format("{}", spec.contrast_temperature),
                        temperature_range);
  if (!spec.touch && spec.object != ObjectEncoder::none)
    return out_of_range("object", name_in(object_names, spec.object), "'none' without touch");
  return std::nullopt;
}

double number_in(const json& value, const char* key, double min, double max, const char* expected) {
  const double number = value.is_number() ? value.get<double>() : NAN;
  if (!(number >= min && number <= max)) throw rejected(key, value, expected);
  return number;
}

Activation activation_in(const json& value, const char* key) {
  for (const auto activation : {Activation::relu, Activation::silu, Activation::tanh})
    if (value == std::string(name_of(activation))) return activation;
  throw rejected(key, value, "one of 'relu', 'silu', 'tanh'");
}

std::array<int, 3> strides_in(const json& value, const char* key) {
  if (!value.is_array() || value.size() != 3) throw rejected(key, value, strides_range);
  std::array<int, 3> strides{};
  for (std::size_t i = 0; i < strides.size(); ++i) {
    if (value[i] != 1 && value[i] != 2) throw rejected(key, value, strides_range);
    strides[i] = value[i].get<int>();
  }
  return strides;
}

void read_integer(const json& document, const IntegerField& field, ModelSpec& spec) {
  const bool is_optional =
      std::ranges::find(optional_keys, std::string_view(field.key)) != optional_keys.end();
  if (is_optional && !document.contains(field.key)) return;
  const auto& value = document.at(field.key);
  if (!is_integer(value) || !contains(field, value.get<std::int64_t>()))
    throw rejected(field.key, value, range_of(field));
  spec.*field.value = value.get<int>();
}

}  // namespace

void to_json(json& document, const ModelSpec& spec) {
  document = {{"touch", spec.touch},
              {"window_frames", spec.window_frames},
              {"rows", spec.rows},
              {"cols", spec.cols},
              {"tactile_kernel", spec.tactile_kernel},
              {"tactile_strides", spec.tactile_strides},
              {"hidden", spec.hidden},
              {"embedding", spec.embedding},
              {"state", spec.state},
              {"band_quantile", spec.band_quantile},
              {"dynamics", name_in(dynamics_names, spec.dynamics)},
              {"activation", name_of(spec.activation)}};
  if (spec.object == ObjectEncoder::none) return;
  document.update({{"object", name_in(object_names, spec.object)},
                   {"segment_frames", spec.segment_frames},
                   {"contrast_temperature", spec.contrast_temperature}});
}

void from_json(const json& document, ModelSpec& spec) {
  const auto& touch = document.at("touch");
  if (!touch.is_boolean()) throw rejected("touch", touch, "true or false");
  spec.touch = touch.get<bool>();
  for (const auto& field : integer_fields) read_integer(document, field, spec);
  const auto read = [&](const char* key, auto set) {
    if (document.contains(key)) set(document.at(key), key);
  };
  read("tactile_strides",
       [&](const json& value, const char* key) { spec.tactile_strides = strides_in(value, key); });
  read("band_quantile", [&](const json& value, const char* key) {
    spec.band_quantile = number_in(value, key, 0.0, 0.5, band_range);
  });
  read("dynamics", [&](const json& value, const char* key) {
    spec.dynamics = parse(value, key, dynamics_names);
  });
  read("activation",
       [&](const json& value, const char* key) { spec.activation = activation_in(value, key); });
  read("object",
       [&](const json& value, const char* key) { spec.object = parse(value, key, object_names); });
  read("contrast_temperature", [&](const json& value, const char* key) {
    spec.contrast_temperature =
        static_cast<float>(number_in(value, key, 0.0, 100.0, temperature_range));
  });
  if (const auto problem = problem_of(spec))
    throw data_error(*problem, "use a model that touchtrace train wrote");
}

void validate(const ModelSpec& spec) {
  if (const auto problem = problem_of(spec))
    throw usage_error(*problem, "correct the model's specification");
}

}  // namespace touchtrace
