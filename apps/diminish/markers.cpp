#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "core/text.h"
#include "diminish/error.h"
#include "diminish/marker_sheet.h"

namespace diminish {
namespace {

struct MarkersCommand {
  std::filesystem::path out;
  std::vector<std::string> ids = {"0"};
  std::string board;
  std::string dictionary = "DICT_4X4_50";
  std::string page = "A4";
  double size_mm = 100;
  double quiet_modules = 1;

  void execute() const;
};

/// "3" or "0-5".
void append_ids(const std::string& text, std::vector<int>& ids) {
  constexpr int largest = 9999;
  const auto read = [&](const std::string& part) {
    const auto number = parse_number(part);
    if (!number || *number < 0 || *number > largest || *number != static_cast<int>(*number)) {
      throw Error(fmt::format("--ids: expected ids such as 3 or 0-5, got '{}'", printable(text)));
    }
    return static_cast<int>(*number);
  };
  const std::size_t dash = text.find('-');
  const int first = read(text.substr(0, dash));
  const int last = dash == std::string::npos ? first : read(text.substr(dash + 1));
  for (int id = first; id <= last; ++id) ids.push_back(id);
}

void MarkersCommand::execute() const {
  const Paper& paper = find_paper(page);
  if (!board.empty()) {
    write_board(parse_board(board), paper, out);
  } else {
    MarkerSheet sheet{dictionary, {}, size_mm / 1000, quiet_modules};
    for (const std::string& text : ids) append_ids(text, sheet.ids);
    write_marker_sheet(sheet, paper, out);
  }
  fmt::print("Written to {}\n", out.string());
}

}  // namespace

void add_markers(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<MarkersCommand>();
  CLI::App* sub =
      program.add_subcommand("markers", "Writes a sheet of markers, or a board, to print");
  sub->add_option("--out", command->out, "The file: .pdf, .svg or .png")
      ->type_name("FILE")
      ->required();
  auto* ids = sub->add_option("--ids", command->ids, "The markers' ids, such as 0,3 or 0-5")
                  ->delimiter(',')
                  ->capture_default_str();
  auto* size = sub->add_option("--size-mm", command->size_mm, "Side of a marker's black square")
                   ->capture_default_str()
                   ->check(CLI::Range(5.0, 2000.0));
  auto* dictionary = sub->add_option("--dictionary", command->dictionary,
                                     "The markers' dictionary, by OpenCV's name")
                         ->capture_default_str();
  auto* quiet = sub->add_option("--quiet-modules", command->quiet_modules,
                                "White border around a marker, in marker cells")
                    ->capture_default_str()
                    ->check(CLI::Range(0.5, 10.0));
  sub->add_option("--page", command->page, "Paper")
      ->capture_default_str()
      ->type_name("{A4,A3,letter}");
  sub->add_option("--board", command->board,
                  "A calibration board instead of markers: "
                  "charuco:COLUMNSxROWS:SQUARE_MM:MARKER_MM[:DICTIONARY] (squares) or "
                  "checkerboard:COLUMNSxROWS:SQUARE_MM (inner corners)")
      ->excludes(ids)
      ->excludes(size)
      ->excludes(dictionary)
      ->excludes(quiet);
  sub->callback([command, &exit_code] {
    command->execute();
    exit_code = 0;
  });
}

}  // namespace diminish
