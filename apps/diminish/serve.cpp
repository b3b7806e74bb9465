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
  LiveRun run = setup.start();
  const WebServer web(*run.session, server);
  fmt::print("Open {}\n", web.url());
  std::fflush(stdout);
  while (!stop_requested()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    run.say_output_problem();
  }
  return 0;
}

}  // namespace

void add_serve(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<ServeCommand>();
  CLI::App* sub = program.add_subcommand("serve", "Runs live and shows the result on a web page");
  command->setup.add_flags(*sub);
  command->setup.add_output_flags(*sub);
  sub->add_option("--port", command->server.port, "Port to listen on; 0: any free one")
      ->capture_default_str()
      ->check(CLI::Range(0, 65535))
      ->type_name("PORT");
  sub->add_option("--listen", command->server.address,
                  "Address to listen on; any address but loopback needs a token")
      ->capture_default_str()
      ->type_name("ADDRESS");
  sub->add_option(
         "--token", command->server.token,
         "Token that requests must carry; if one is needed and not given, it is made and printed")
      ->type_name("TEXT");
  sub->add_option("--recordings", command->server.recordings,
                  "Folder for the page's record button; without it the page cannot record")
      ->type_name("FOLDER");
  sub->add_option("--viewers", command->server.most_viewers, "Most viewers at a time")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
