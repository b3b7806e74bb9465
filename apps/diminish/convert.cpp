#include "setup/convert/convert.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "diminish/error.h"
#include "ros/bag/bag.h"
#include "setup/convert/tum_format.h"

namespace diminish {
namespace {

struct ConvertCommand {
  std::filesystem::path from, to;
  std::string color, tum;
  std::vector<std::string> rgbd;
  std::vector<double> lens;

  int execute() const;
  BagChoice choice() const;
  Conversion convert() const;
};

/// "NAME=COLOR,DEPTH"
BagChoice ConvertCommand::choice() const {
  BagChoice choice;
  choice.color = color;
  for (const std::string& text : rgbd) {
    const std::size_t equals = text.find('=');
    const std::size_t comma = text.find(',');
    if (equals == std::string::npos || comma == std::string::npos || comma < equals) {
      throw Error("--rgbd: expected NAME=COLOR_TOPIC,DEPTH_TOPIC, got '" + text + "'");
    }
    choice.rgbd.push_back({text.substr(0, equals), text.substr(equals + 1, comma - equals - 1),
                           text.substr(comma + 1)});
  }
  return choice;
}

Conversion ConvertCommand::convert() const {
  std::error_code ignored;
  if (std::filesystem::exists(from / "rig.yaml", ignored)) {
    return tum.empty() ? convert_to_bag(from, to) : convert_to_tum(from, to, tum);
  }
  if (is_tum_folder(from)) {
    Intrinsics camera = read_tum_camera(from).value_or(tum_lens());
    if (!lens.empty()) {
      camera.fx = lens[0];
      camera.fy = lens[1];
      camera.cx = lens[2];
      camera.cy = lens[3];
    }
    return convert_tum(from, to, camera);
  }
  if (is_matroska(from)) return convert_kinect(from, to);
  if (ros::is_bag(from)) return convert_bag(from, to, choice());
  throw Error(Error::input, from.string() +
                                ": expected a recording, a ROS bag, an MCAP file, an Azure "
                                "Kinect's .mkv or a TUM RGB-D folder");
}

int ConvertCommand::execute() const {
  const Conversion conversion = convert();
  for (const Conversion::Stream& stream : conversion.streams) {
    fmt::print("{:<16} {:>6} images  {}\n", stream.name, stream.images, stream.from);
  }
  if (conversion.left_out > 0) fmt::print("{} images left out\n", conversion.left_out);
  for (const std::string& problem : conversion.problems) fmt::print("  {}\n", problem);
  fmt::print("Written to {}\n", to.string());
  constexpr int done_but_for_images = 3;
  return conversion.left_out > 0 ? done_but_for_images : 0;
}

}  // namespace

void add_convert(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<ConvertCommand>();
  CLI::App* sub = program.add_subcommand(
      "convert",
      "Makes a recording of a ROS bag, an MCAP file, an Azure Kinect's .mkv or a TUM RGB-D folder; "
      "or a ROS 2 bag, an MCAP file or a TUM RGB-D folder of a recording");
  sub->add_option("from", command->from, "What to read")->required();
  sub->add_option("to", command->to, "The folder to make; FILE.mcap: of a recording, an MCAP file")
      ->required();
  sub->add_option(
         "--color", command->color,
         "Of a bag: the topic of the user's view; default: the first RGB-D camera's colour")
      ->type_name("TOPIC");
  sub->add_option(
         "--rgbd", command->rgbd,
         "Of a bag: an RGB-D camera's topics; default: each topic of depth with the colour "
         "whose name is most like it")
      ->type_name("NAME=COLOR,DEPTH");
  sub->add_option("--tum", command->tum,
                  "Of a recording: make a TUM RGB-D folder of this RGB-D camera, not a bag")
      ->type_name("CAMERA");
  sub->add_option("--camera-matrix", command->lens,
                  "Of a TUM RGB-D folder that does not tell it; default: 525 525 319.5 239.5")
      ->expected(4)
      ->type_name("FX FY CX CY");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
