#include <fmt/core.h>

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/json_number.h"
#include "pipeline/acquire/board_size.h"
#include "pipeline/acquire/board_views.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t max_bytes = 1u << 28;

Error invalid(const fs::path& file, const std::string& problem) {
  return data_error(fmt::format("{}: {}", file.string(), problem),
                    "give calibration.json of `touchtrace calibrate`, or text with lines "
                    "'filename x y level' as mrcal reads it");
}

/// Throws data_error unless each corner is one of the board's, and seen once.
void require_board_corners(const fs::path& file, const BoardView& view,
                           const CalibrationTarget& board) {
  const auto count = static_cast<std::size_t>(board.num_corners());
  if (view.corner_ids.empty() && view.corners_px.size() != count)
    throw invalid(file, fmt::format("{} has {} corners, the board of {}x{} has {}", view.name,
                                    view.corners_px.size(), board.columns, board.rows, count));
  if (!view.corner_ids.empty() && view.corner_ids.size() != view.corners_px.size())
    throw invalid(file, fmt::format("{} has {} corners and {} corner_ids", view.name,
                                    view.corners_px.size(), view.corner_ids.size()));
  std::vector<bool> seen(count, false);
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    const auto id = static_cast<std::size_t>(view.corner_id(i));
    if (view.corner_id(i) < 0 || id >= count || seen[id])
      throw invalid(file, fmt::format("{} has corner {} twice, or the board of {}x{} has none",
                                      view.name, view.corner_id(i), board.columns, board.rows));
    seen[id] = true;
  }
}

BoardView view_from_json(const json& entry) {
  BoardView view{entry.at("name"), {}, {}, entry.value("corner_ids", std::vector<int>{})};
  for (const auto& corner : entry.at("corners_px"))
    view.corners_px.emplace_back(corner.at(0).get<double>(), corner.at(1).get<double>());
  return view;
}

void read_json(const fs::path& file, const std::string& text, BoardObservations& observations) {
  const json document = json::parse(text);
  observations.width = document.at("color").at("width");
  observations.height = document.at("color").at("height");
  if (observations.width < 1 || observations.height < 1)
    throw invalid(file, "color.width and color.height have to be positive");
  for (const auto& entry : document.at("details").at("views"))
    observations.views.push_back(view_from_json(entry));
}

/// Next corner of a view, unless "-" or a negative level says that it was not seen.
void add_corner(std::istringstream& line, BoardView& view, int id) {
  std::string x, y, level;
  line >> x >> y >> level;
  if (x == "-" || y == "-" || level == "-" || level.starts_with('-')) return;
  view.corners_px.emplace_back(std::stod(x), std::stod(y));
  view.corner_ids.push_back(id);
}

void read_lines(const fs::path& file, const std::string& text, BoardObservations& observations) {
  std::map<std::string, std::pair<BoardView, int>> views;  // with the number of lines so far
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    if (!(words >> name) || name.starts_with('#')) continue;
    auto& [view, count] = views[name];
    view.name = name;
    add_corner(words, view, count++);
  }
  for (auto& [name, entry] : views) {
    auto& [view, count] = entry;
    if (view.corners_px.empty()) {
      observations.views_without_board.push_back(name);
      continue;
    }
    if (observations.width == 0) {  // the text does not tell it
      const GreyImage image = read_grey(file.parent_path() / name);
      observations.width = image.width, observations.height = image.height;
    }
    if (view.corners_px.size() == static_cast<std::size_t>(count)) view.corner_ids.clear();  // all
    observations.views.push_back(std::move(view));
  }
}

}  // namespace

std::optional<BoardSize> board_size_of_corners(const fs::path& file) {
  const json document = json::parse(read_file(file, max_bytes), nullptr, false);
  const json::json_pointer pointer("/details/board");
  if (!document.contains(pointer)) return std::nullopt;
  const json& board = document[pointer];
  if (!board.is_object() || board.value("target", json()) != chessboard_kind.name)
    return std::nullopt;
  const auto size = [&](const char* name) {
    return static_cast<int>(whole_number(board.value(name, json()), name, 3, 100));
  };
  return BoardSize{size("columns"), size("rows")};
}

BoardObservations board_views_from_corners(const fs::path& file, const CalibrationTarget& board) {
  BoardObservations observations;
  observations.board = board;
  const std::string text = read_file(file, max_bytes);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  try {
    if (first != std::string::npos && text[first] == '{')
      read_json(file, text, observations);
    else
      read_lines(file, text, observations);
  } catch (const json::exception& error) {
    throw invalid(file, error.what());
  } catch (const std::logic_error&) {  // of std::stod
    throw invalid(file, "a coordinate is not a number");
  }
  for (const BoardView& view : observations.views) require_board_corners(file, view, board);
  return observations;
}

}  // namespace touchtrace
