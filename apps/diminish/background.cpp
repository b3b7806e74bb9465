#include "background.h"

#include "diminish/error.h"

namespace diminish {

void Background::add_flag(CLI::App& command, Options& options) {
  const CLI::Option* memory = command.get_option("--memory");
  command
      .add_option_function<std::string>(
          "--background",
          [this, &options, memory](const std::string& folder) {
            folder_ = folder;
            if (memory->count() == 0) options.memory = "on";
            if (options.memory == "off")
              throw CLI::ValidationError("--background", "needs --memory on");
          },
          "What was seen of the place before: a folder that `diminish scan` made. Switches "
          "--memory on")
      ->type_name("FOLDER");
}

std::shared_ptr<const Scan> Background::load() const {
  if (folder_.empty()) return nullptr;
  return std::make_shared<const Scan>(load_scan(folder_));
}

}  // namespace diminish
