#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "core/text.h"
#include "diminish/error.h"
#include "ros/compressed_depth.h"
#include "ros/pixel_encodings.h"
#include "setup/convert/bag_images.h"
#include "setup/convert/convert.h"
#include "setup/convert/converted_recording.h"
#include "sink/recording_folder.h"
#include "source/image_header.h"

namespace diminish {
namespace {

constexpr std::size_t most_problems = 5;

/// How much of their beginnings two names share.
std::size_t shared(const std::string& a, const std::string& b) {
  const auto [end, ignored] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  return static_cast<std::size_t>(end - a.begin());
}

std::string listed(const BagSurvey& survey) {
  std::string text;
  for (const BagStream& stream : survey.streams) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", stream.topic,
                        stream.sensor == Sensor::color ? "colour" : "depth");
  }
  if (!text.empty()) return text;
  // So that its owner sees what it is.
  constexpr std::size_t most_topics = 5;
  text = "no images";
  std::size_t count = 0;
  for (const auto& [topic, type] : survey.others) {
    if (count == most_topics) return text + fmt::format(", {} more", survey.others.size() - count);
    text +=
        fmt::format("{}{} ({})", count++ == 0 ? ", but " : ", ", printable(topic), printable(type));
  }
  return text;
}

const BagStream& find(const BagSurvey& survey, const std::string& topic, Sensor sensor) {
  for (const BagStream& stream : survey.streams) {
    if (stream.topic == topic && stream.sensor == sensor) return stream;
  }
  throw Error(fmt::format("{}: expected a topic of {} images, the bag has {}", printable(topic),
                          sensor == Sensor::color ? "colour" : "depth", listed(survey)));
}

/// Each topic of depth, with the topic of colour whose name is most like it.
std::vector<BagChoice::Camera> chosen_cameras(const BagSurvey& survey) {
  std::vector<BagChoice::Camera> cameras;
  for (const BagStream& depth : survey.streams) {
    if (depth.sensor != Sensor::depth) continue;
    const BagStream* best = nullptr;
    for (const BagStream& color : survey.streams) {
      if (color.sensor != Sensor::color) continue;
      if (!best || shared(color.topic, depth.topic) > shared(best->topic, depth.topic))
        best = &color;
    }
    const bool is_new =
        best && std::none_of(cameras.begin(), cameras.end(),
                             [&](const auto& known) { return known.color == best->topic; });
    if (is_new) {
      cameras.push_back({fmt::format("rgbd{}", cameras.size()), best->topic, depth.topic});
    }
  }
  return cameras;
}

/// A lens that sees 60 degrees, where the bag tells none.
Intrinsics lens_of(const BagStream& stream, std::string& notes) {
  if (stream.lens) return *stream.lens;
  notes += fmt::format(
      "# {}: the bag tells no lens; this one is a guess: `diminish calibrate intrinsics`\n",
      stream.topic);
  constexpr double focal_length = 0.87;  // picture widths
  return {.width = stream.width,
          .height = stream.height,
          .fx = focal_length * stream.width,
          .fy = focal_length * stream.width,
          .cx = (stream.width - 1) / 2.,
          .cy = (stream.height - 1) / 2.};
}

RgbdCamera camera_of(const BagSurvey& survey, const BagChoice::Camera& choice, std::string& notes) {
  const BagStream& color = find(survey, choice.color, Sensor::color);
  const BagStream& depth = find(survey, choice.depth, Sensor::depth);
  RgbdCamera camera;
  camera.name = choice.name;
  camera.color = lens_of(color, notes);
  camera.depth = lens_of(depth, notes);
  camera.depth_unit_m = depth.depth_unit_m;
  const bool is_aligned = depth.topic.find("aligned_depth_to_") != std::string::npos ||
                          (!color.frame_id.empty() && color.frame_id == depth.frame_id);
  const auto told = survey.frames.find(color.frame_id, depth.frame_id);
  if (told) camera.color_from_depth = *told;
  if (!told && !is_aligned) {
    notes += fmt::format(
        "# {}: the bag does not tell color_from_depth; that both sensors are one is a guess: "
        "`diminish calibrate rig RECORDING --depth`\n",
        camera.name);
  }
  return camera;
}

/// Where a topic's images go: to one stream, and maybe as the user's view too.
struct Target {
  std::optional<ConvertedStream> stream;
  std::optional<ConvertedStream> users_view;
  double unit_m = 0.001;
};

void write(const BagImage& image, Target& target, Conversion& conversion) {
  const double stamp_s = image.header.stamp_s;
  const auto add = [&](ConvertedStream& stream) {
    if (image.sensor == Sensor::depth) {
      Image<std::uint16_t> depth;
      // As the bag has them: the rig has their unit.
      if (image.raw) ros::read_depth(*image.raw, ros::millimetre_m, depth);
      if (image.compressed) ros::read_compressed_depth(*image.compressed, ros::millimetre_m, depth);
      return stream.add(stamp_s, depth);
    }
    Image<Bgr> color;
    if (image.compressed) {
      ros::read_color(*image.compressed, color);
      const auto bytes = image.compressed->data;
      if (is_jpeg(bytes)) {
        return stream.add(stamp_s, {reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                          ".jpg");
      }
    } else {
      ros::read_color(*image.raw, color);
    }
    return stream.add(stamp_s, color);
  };
  ConvertedStream& first = target.stream ? *target.stream : *target.users_view;
  if (!add(first)) {
    ++conversion.left_out;
  } else if (target.stream && target.users_view) {
    target.users_view->add_file(stamp_s, first.last_file());
  }
}

}  // namespace

Conversion convert_bag(const std::filesystem::path& bag, const std::filesystem::path& recording,
                       const BagChoice& choice) {
  const BagSurvey survey = survey_bag(bag);
  const auto named = [&](auto call) {
    try {
      return call();
    } catch (const Error& error) {
      throw Error(error.category(), bag.string() + ": " + error.what());
    }
  };
  std::string notes;
  Rig rig;
  std::map<std::string, Target> targets;
  std::vector<BagChoice::Camera> cameras;
  std::string users_view;
  bool is_first = false;
  named([&] {
    cameras = choice.rgbd.empty() ? chosen_cameras(survey) : choice.rgbd;
    if (cameras.empty()) {
      throw Error(Error::input,
                  "expected topics of colour and of depth images, got " + listed(survey));
    }
    for (const auto& camera : cameras) rig.rgbd.push_back(camera_of(survey, camera, notes));
    users_view = choice.color.empty() ? cameras.front().color : choice.color;
    is_first = users_view == cameras.front().color;
    rig.color =
        is_first ? rig.rgbd[0].color : lens_of(find(survey, users_view, Sensor::color), notes);
  });
  make_recording_folder(recording);
  targets[users_view].users_view.emplace(recording, "color");
  for (const auto& camera : cameras) {
    targets[camera.color].stream.emplace(recording, camera.name + "_color");
    targets[camera.depth].stream.emplace(recording, camera.name + "_depth");
  }
  Conversion conversion;
  const auto reader = ros::open_bag(bag);
  for (ros::BagMessage message; reader->next(message);) {
    const auto target = targets.find(message.topic);
    if (target == targets.end()) continue;
    try {
      if (const auto image = read_bag_image(message)) write(*image, target->second, conversion);
    } catch (const Error& error) {
      if (error.category() != Error::input) throw;
      ++conversion.left_out;
      if (conversion.problems.size() < most_problems) {
        conversion.problems.push_back(message.topic + ": " + error.what());
      }
    }
  }
  write_set_up(recording, rig, is_first, notes);
  conversion.streams.push_back({"color", users_view, targets[users_view].users_view->images()});
  for (const auto& camera : cameras) {
    conversion.streams.push_back(
        {camera.name + "_color", camera.color, targets[camera.color].stream->images()});
    conversion.streams.push_back(
        {camera.name + "_depth", camera.depth, targets[camera.depth].stream->images()});
  }
  return conversion;
}

}  // namespace diminish
