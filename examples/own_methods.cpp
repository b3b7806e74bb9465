// Methods of one's own, added from outside the library: a detector with settings of its own and an
// inpainting method. The scene is made here, without a file.
//   own_methods RECORDING    whose cameras and frames are used, with a disc to remove
#include <cstdio>
#include <exception>
#include <memory>

#include "diminish/diminish.h"

namespace {

/// What is to be known of a disc in the user's view.
class DiscSettings : public diminish::OccluderSettings {
 public:
  int x = 0, y = 0, radius = 0;  ///< pixels

  void check(const diminish::Config& place, const diminish::Rig*) const override {
    if (radius < 1) place.find("radius").fail("expected 1 or more pixels");
  }
};

class DiscDetector : public diminish::OccluderDetector {
 public:
  DiscDetector(std::string name, const DiscSettings& disc) : name_(std::move(name)), disc_(disc) {}

  diminish::OccluderReport detect(const diminish::Observation& observation,
                                  diminish::OcclusionMasks& masks) override {
    for (int y = 0; y < masks.color.height(); ++y) {
      for (int x = 0; x < masks.color.width(); ++x) {
        const int dx = x - disc_.x;
        const int dy = y - disc_.y;
        if (dx * dx + dy * dy <= disc_.radius * disc_.radius) masks.color(x, y) = 255;
      }
    }
    diminish::OccluderReport report;
    report.name = name_;
    report.in_color = true;
    report.in_rgbd.assign(observation.frame.rgbd.size(), false);
    return report;
  }

 private:
  std::string name_;
  DiscSettings disc_;
};

std::shared_ptr<const diminish::OccluderSettings> read_disc(const diminish::Config& place) {
  place.expect_keys({"name", "detector", "x", "y", "radius"});
  auto disc = std::make_shared<DiscSettings>();
  disc->x = place.at("x").integer(0, 16384);
  disc->y = place.at("y").integer(0, 16384);
  disc->radius = place.at("radius").integer(1, 16384);
  return disc;
}

const bool detector_registered = diminish::Registry<diminish::OccluderDetector>::add(
    "disc",
    {.read = read_disc, .make = [](const diminish::OccluderSpec& spec, const diminish::Rig&) {
       return std::make_unique<DiscDetector>(spec.name, diminish::settings_of<DiscSettings>(spec));
     }});

constexpr diminish::Bgr green{0, 255, 0};

class GreenFilling : public diminish::Inpainter {
 public:
  bool inpaint(const diminish::Holes& holes, const diminish::Options&,
               diminish::Image<diminish::Bgr>& picture) override {
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        if (holes.missing(x, y) != 0) picture(x, y) = green;
      }
    }
    return true;
  }
};

const bool inpainter_registered = diminish::Registry<diminish::Inpainter>::add(
    "green", [] { return std::make_unique<GreenFilling>(); });

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: own_methods RECORDING\n");
    return 2;
  }
  std::printf("detectors: %s\n", diminish::Registry<diminish::OccluderDetector>::known().c_str());
  for (const std::string& name : diminish::method_names("inpaint")) {
    std::printf("--inpaint %s\n", name.c_str());
  }
  const diminish::Recording recording = diminish::load_recording(argv[1]);
  auto disc = std::make_shared<DiscSettings>();
  disc->x = recording.rig.color.width / 2;
  disc->y = recording.rig.color.height / 2;
  disc->radius = 100;
  diminish::Scene scene;
  scene.marker_dictionary = recording.scene.marker_dictionary;
  scene.world_marker = recording.scene.world_marker;
  scene.occluders = {{"disc", "disc", disc}};

  diminish::Options options;
  options.inpaint = "green";
  options.lift_shadows = false;
  const auto source = diminish::open_recording(recording, options);
  diminish::Pipeline pipeline(recording.rig, scene, options);
  diminish::FrameSet frame;
  diminish::DiminishedFrame result;
  while (source->next(frame)) {
    // Without the RGB-D cameras' images nothing is seen behind the disc: all of it is filled.
    for (diminish::RgbdFrame& rgbd : frame.rgbd) rgbd.missing = "not used here";
    pipeline.process(frame, result);
    const diminish::Bgr middle = result.picture(disc->x, disc->y);
    std::printf("%s: %zu pixels filled, the middle %s green\n", result.name.c_str(),
                result.report.missing_pixels, middle == green ? "is" : "is not");
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
