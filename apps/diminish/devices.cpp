#include <fmt/format.h>

#include "commands.h"
#include "diminish/camera_source.h"
#include "diminish/error.h"

namespace diminish {
namespace {

int list_devices() {
  using Sources = Registry<CameraSource>;
  fmt::print("Kinds of cameras\n");
  for (const std::string& scheme : Sources::names()) {
    fmt::print("  {}\n", Sources::get(scheme).help);
  }
  fmt::print("\nConnected devices\n");
  std::size_t count = 0;
  for (const std::string& scheme : Sources::names()) {
    const auto& list = Sources::get(scheme).list;
    if (!list) continue;
    try {
      for (const CameraDevice& device : list()) {
        fmt::print("  {:<32} {}\n", device.uri, device.description);
        ++count;
      }
    } catch (const Error& error) {
      fmt::print(stderr, "diminish: {}\n", error.what());
    }
  }
  if (count == 0) fmt::print("  none\n");
  return 0;
}

}  // namespace

void add_devices(CLI::App& program, int& exit_code) {
  CLI::App* sub =
      program.add_subcommand("devices", "Lists the kinds of cameras and the connected devices");
  sub->callback([&exit_code] { exit_code = list_devices(); });
}

}  // namespace diminish
