#include <fmt/core.h>

#include "pipeline/report/page.h"
#include "pipeline/report/report.h"

namespace touchtrace::report {
namespace {

/// In the order in which they build on each other.
constexpr const char* scripts[] = {"dom.js",     "chart.js",    "paths.js",  "tactile.js",
                                   "results.js", "rollouts.js", "labels.js", "calibration.js",
                                   "figures.js", "main.js"};

void put(std::string& page, const std::string& place, const std::string& text) {
  page.replace(page.find(place), place.size(), text);
}

/// JSON that cannot end the element it stands in.
std::string embedded(const nlohmann::json& data) {
  const std::string text = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (char c : text) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

}  // namespace

std::string render(const nlohmann::json& data) {
  const auto& files = report_page();
  std::string script;
  for (const char* name : scripts) script += std::string(files.at(name)) + "\n";
  std::string page(files.at("report.html"));
  put(page, "@STYLE@", std::string(files.at("style.css")));
  put(page, "@SCRIPT@", script);
  put(page, "@DATA@", embedded(data));  // last: the data may hold anything
  return page;
}

}  // namespace touchtrace::report
