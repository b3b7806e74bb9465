#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <thread>

#include "commands.h"
#include "diminish/web_server.h"
#include "live_setup.h"
#include "serve/access.h"

namespace diminish {
namespace {

struct ServeCommand {
  LiveSetup setup;
  WebServerOptions server;

  int execute();
};

int ServeCommand::execute() {
  if (!is_loopback(server.address) && server.token.empty()) server.token = make_token();
  server.rig_file = setup.rig_file();
  server.scene_file = setup.scene_file();
  stop_on_signals();
  const LiveRun run = setup.start();
  const WebServer web(*run.session, server);
  fmt::print("Look at {}\n", web.url());
  std::fflush(stdout);
  while (!stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return 0;
}

}  // namespace

void add_serve(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<ServeCommand>();
  CLI::App* sub =
      program.add_subcommand("serve", "Runs live and shows the result on a web page of its own");
  command->setup.add_flags(*sub);
  command->setup.add_output_flags(*sub);
  sub->add_option("--port", command->server.port, "0: any that is free")
      ->capture_default_str()
      ->check(CLI::Range(0, 65535))
      ->type_name("PORT");
  sub->add_option("--listen", command->server.address,
                  "The address to listen on; any but loopback makes a token necessary")
      ->capture_default_str()
      ->type_name("ADDRESS");
  sub->add_option("--token", command->server.token,
                  "What requests must carry; made and printed where it is necessary")
      ->type_name("TEXT");
  sub->add_option("--recordings", command->server.recordings,
                  "Where the page's record button puts recordings; without it there is none")
      ->type_name("FOLDER");
  sub->add_option("--viewers", command->server.most_viewers, "At most so many at a time")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
