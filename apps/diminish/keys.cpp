#include "setup/keys/keys.h"

#include <fmt/format.h>

#include <memory>

#include "commands.h"

namespace diminish {
namespace {

int print_made(const std::filesystem::path& folder, const KeysRequest& request) {
  const KeysMade made = make_keys(folder, request);
  if (made.is_new_authority) {
    fmt::print("New certificate authority; whoever has {} can make keys\n",
               (folder / "private").string());
  }
  for (const auto& own : made.folders) fmt::print("keys={}\n", own.string());
  return 0;
}

}  // namespace

void add_keys(CLI::App& program, int& exit_code) {
  struct KeysCommand {
    std::filesystem::path folder;
    KeysRequest request;
  };
  auto command = std::make_shared<KeysCommand>();
  CLI::App* sub = program.add_subcommand(
      "keys", "Makes keys for ROS 2's wire: who has none sees and sends nothing (DDS Security)");
  sub->add_option("folder", command->folder,
                  "Where keys are made; a folder of SROS2's, or of an earlier call, is extended")
      ->required();
  sub->add_option("names", command->request.names,
                  "Of the machines or programs that get keys, such as camera_host")
      ->required();
  sub->add_option("--publish", command->request.publish,
                  "What these may send, such as \"/rgbd0/*\"; default: everything, if --subscribe "
                  "is left out, too")
      ->type_name("TOPIC");
  sub->add_option("--subscribe", command->request.subscribe,
                  "What these may receive; default: everything, if --publish is left out, too")
      ->type_name("TOPIC");
  sub->add_option("--days", command->request.days, "For how long the keys are good")
      ->capture_default_str()
      ->check(CLI::Range(1, 36500));
  sub->callback(
      [command, &exit_code] { exit_code = print_made(command->folder, command->request); });
}

}  // namespace diminish
