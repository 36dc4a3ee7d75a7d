#include <fmt/core.h>

#include "pipeline/report/page.h"
#include "pipeline/report/report.h"

namespace touchtrace::report {
namespace {

/// In order of dependency.
constexpr const char* scripts[] = {"dom.js",         "chart.js",   "paths.js",    "tactile.js",
                                   "results.js",     "options.js", "rollouts.js", "labels.js",
                                   "calibration.js", "figures.js", "main.js"};

void fill(std::string& page, const std::string& placeholder, const std::string& text) {
  page.replace(page.find(placeholder), placeholder.size(), text);
}

/// JSON without `<`, which cannot end its <script> element.
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
  fill(page, "@STYLE@", std::string(files.at("style.css")));
  fill(page, "@SCRIPT@", script);
  fill(page, "@DATA@", embedded(data));  // last: the data may contain placeholders
  return page;
}

}  // namespace touchtrace::report
