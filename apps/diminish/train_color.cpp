#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "commands.h"
#include "detect/color_blob/color_model.h"
#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "diminish/occluder_settings.h"

namespace diminish {
namespace {

void train(const std::filesystem::path& folder, const std::string& title) {
  const ColorModel model = train_color_model(folder);
  const std::filesystem::path file = color_model_file(folder);
  fmt::print(
      "{}: hue {:.1f} +- {:.1f} degrees, saturation {:.2f} +- {:.2f}, value {:.2f} +- {:.2f}\n",
      title, model.hue_deg, model.hue_spread_deg, model.saturation, model.saturation_spread,
      model.value, model.value_spread);
  if (!save_color_model(model, file)) throw Error(file.string() + ": cannot be written");
  fmt::print("  {}\n", file.string());
}

void train_all(const std::filesystem::path& folder) {
  const Recording recording = load_recording(folder);
  bool any = false;
  for (const OccluderSpec& occluder : recording.scene.occluders) {
    const auto* const settings = dynamic_cast<const ColorBlobSettings*>(occluder.settings.get());
    if (settings == nullptr) continue;
    any = true;
    const std::filesystem::path& training = settings->training;
    train(training_folder(training, "color"), occluder.name + " in color");
    for (const RgbdCamera& camera : recording.rig.rgbd) {
      const std::filesystem::path own = training_folder(training, camera.name);
      if (own != training_folder(training, "color")) {
        train(own, occluder.name + " in " + camera.name);
      }
    }
  }
  if (!any) {
    throw Error((folder / "scene.yaml").string() +
                ": expected an occluder with detector color_blob");
  }
}

}  // namespace

void add_train_color(CLI::App& program, int& exit_code) {
  CLI::App* command = program.add_subcommand(
      "train-color", "Learns the colours of a recording's color_blob objects from training images");
  auto folder = std::make_shared<std::string>();
  command->add_option("recording", *folder, "The recording's folder")
      ->type_name("FOLDER")
      ->required();
  command->callback([folder, &exit_code] {
    train_all(*folder);
    exit_code = 0;
  });
}

}  // namespace diminish
