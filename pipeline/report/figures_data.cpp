#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/report/artefact_data.h"

namespace touchtrace::report {
namespace {

using nlohmann::json;

constexpr std::uintmax_t max_figures_bytes = 16u << 20;

bool has(const json& object, std::initializer_list<const char*> keys,
         bool (json::*is)() const noexcept) {
  return object.is_object() && std::ranges::all_of(keys, [&](const char* key) {
           return object.contains(key) && (object.at(key).*is)();
         });
}

bool is_curve(const json& curve) {
  return has(curve, {"name"}, &json::is_string) && has(curve, {"x", "y"}, &json::is_array) &&
         curve.at("x").size() == curve.at("y").size();
}

bool is_picture(const json& picture) {
  return has(picture, {"x_label", "y_label"}, &json::is_string) &&
         has(picture, {"curves"}, &json::is_array) &&
         std::ranges::all_of(picture.at("curves"), is_curve);
}

bool is_figure(const json& figure) {
  return has(figure, {"name", "unit", "goal"}, &json::is_string) &&
         has(figure, {"holds"}, &json::is_boolean) && figure.contains("value") &&
         (!figure.contains("picture") || is_picture(figure.at("picture")));
}

}  // namespace

json figures_data(const std::filesystem::path& path) {
  const json document = json::parse(read_file(path, max_figures_bytes), nullptr, false);
  if (!has(document, {"figures"}, &json::is_array) ||
      !std::ranges::all_of(document.at("figures"), is_figure))
    throw data_error(fmt::format("{} contains no figures of touchtrace-verify", path.string()),
                     "write it with touchtrace-verify AREA --json, or leave it out");
  return {{"name", path.filename().string()}, {"figures", document.at("figures")}};
}

}  // namespace touchtrace::report
