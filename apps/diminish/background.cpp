#include "background.h"

#include "diminish/error.h"

namespace diminish {

void Background::add_flag(CLI::App& command, Options& options) {
  command
      .add_option_function<std::string>(
          "--background",
          [this, &options](const std::string& folder) {
            folder_ = folder;
            if (options.memory == "off")
              throw CLI::ValidationError("--background", "needs --memory on");
          },
          "What was seen of the place before: a folder that `diminish scan` made")
      ->type_name("FOLDER");
}

std::shared_ptr<const Scan> Background::load() const {
  if (folder_.empty()) return nullptr;
  return std::make_shared<const Scan>(load_scan(folder_));
}

}  // namespace diminish
