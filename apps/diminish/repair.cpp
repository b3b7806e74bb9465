#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands.h"
#include "setup/repair/recording_repair.h"

namespace diminish {
namespace {

int repair(const std::filesystem::path& folder) {
  const RecordingRepair repair = repair_recording(folder);
  for (const ListRepair& list : repair.lists) {
    fmt::print("{}: {} entries{}\n", list.list, list.kept,
               list.left_out.empty() ? "" : fmt::format(", {} left out:", list.left_out.size()));
    for (const std::string& entry : list.left_out) fmt::print("  {}\n", entry);
  }
  for (const std::filesystem::path& file : repair.deleted) {
    fmt::print("deleted: {}\n", file.string());
  }
  if (!repair.was_needed()) fmt::print("The recording is whole.\n");
  return 0;
}

}  // namespace

void add_repair(CLI::App& program, int& exit_code) {
  auto folder = std::make_shared<std::filesystem::path>();
  CLI::App* sub = program.add_subcommand(
      "repair", "Makes a recording whole that was being written when the machine stopped");
  sub->add_option("recording", *folder, "The recording's folder")->type_name("FOLDER")->required();
  sub->callback([folder, &exit_code] { exit_code = repair(*folder); });
}

}  // namespace diminish
