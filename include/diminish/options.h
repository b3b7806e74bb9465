#pragma once

#include <limits>
#include <string>
#include <vector>

#include "diminish/export.h"

namespace diminish {

/// Everything that can be chosen for a run. Names, units, ranges and meanings are described once,
/// in `for_each_option`, from which the command line and the docs are made.
struct Options {
  double sync_tolerance_s = 0;
  int mask_margin_px = 5;
  int contact_line_px = 7;
  int soft_rim_px = 2;
  int rgbd_mask_margin_px = 9;
  double blob_spread = 1.0;
  std::string estimate_depth = "auto";
  bool refine_poses = true;
  bool remove_flying = true;
  bool remove_hidden = true;
  bool smooth_depth = true;
  bool snap_edges = true;
  bool remove_scraps = true;
  bool smooth_colors = true;
  bool complete_sides = true;
  bool close_gaps = true;
  bool draw_bars = true;
  bool lift_shadows = true;
  bool refine_shadows = true;
  bool remove_shadows = false;
  double discontinuity_threshold_m = 0.05;
  double discontinuity_reach_m = 2;
  double depth_agreement_m = 0.03;
  std::string merge_cameras = "blend";
  int surroundings_px = 16;
  bool whole_view = false;
  std::string color_correct = "field_membrane";
  std::string memory = "on";
  double memory_max_age_s = 60;
  std::string inpaint = "structure";
  int inpaint_radius_px = 5;
  std::string mode = "remove";
  std::string keep;
  double transparency = 0.5;
  std::string on_doubt = "mark";
  double least_fit = 0.8;
  std::string backend = "cpu";
};

/// An option's description. The range is inclusive; it has no meaning for texts and switches.
struct OptionInfo {
  const char* name;  ///< as in Options; the command line has "-" instead of "_"
  const char* unit;
  const char* help;
  double min = 0;
  double max = std::numeric_limits<double>::max();
  /// For texts: the kind of the registered methods that it can name (Interface::kind), and further
  /// words that are allowed. Neither: any text.
  const char* kind = "";
  std::vector<std::string> choices = {};
};

/// Calls `visit(info, value)` for each option, `value` being a reference into `options`.
template <class AnyOptions, class Visit>
void for_each_option(AnyOptions& options, Visit&& visit) {
  visit(OptionInfo{"sync_tolerance_s", "seconds",
                   "Largest time difference between a colour image and its RGB-D images; 0: half a "
                   "colour frame period",
                   0, 3600},
        options.sync_tolerance_s);
  visit(OptionInfo{"mask_margin_px", "pixels",
                   "How far the objects' masks grow in the colour image", 0, 200},
        options.mask_margin_px);
  visit(OptionInfo{"contact_line_px", "pixels",
                   "How far beyond its mask the dark line around the foot of an object that stands "
                   "on a plane is looked for, to be removed with it; 0: not",
                   0, 50},
        options.contact_line_px);
  visit(OptionInfo{"soft_rim_px", "pixels",
                   "Width inside the margin over which the camera's picture fades into the "
                   "background; at most half the margin",
                   0, 100},
        options.soft_rim_px);
  visit(OptionInfo{"rgbd_mask_margin_px", "pixels",
                   "How far the masks grow in the RGB-D cameras' colour images; scaled to the same "
                   "angle in their depth images",
                   0, 200},
        options.rgbd_mask_margin_px);
  visit(OptionInfo{"blob_spread", "standard deviations",
                   "How far a blob's mean colour may be from the training images' mean", 0.01, 100},
        options.blob_spread);
  visit(
      OptionInfo{.name = "estimate_depth",
                 .unit = "method",
                 .help = "How the depth of cameras that measure none is found; auto: planes if the "
                         "scene names some, else stereo",
                 .kind = "depth estimation",
                 .choices = {"auto"}},
      options.estimate_depth);
  visit(OptionInfo{"refine_poses", "",
                   "Refine the colour camera's pose until its picture matches the RGB-D cameras'"},
        options.refine_poses);
  visit(OptionInfo{"remove_flying", "", "Drop depth pixels that lie between two surfaces"},
        options.remove_flying);
  visit(OptionInfo{"remove_hidden", "",
                   "Drop depth pixels that the RGB-D camera's colour sensor cannot see"},
        options.remove_hidden);
  visit(
      OptionInfo{"smooth_depth", "", "Average depth over neighbouring pixels of the same surface"},
      options.smooth_depth);
  visit(OptionInfo{"snap_edges", "",
                   "Move depth edges onto the edges of the RGB-D camera's colour image"},
        options.snap_edges);
  visit(OptionInfo{"remove_scraps", "",
                   "Drop small pieces of surfaces that hang in the air by themselves"},
        options.remove_scraps);
  visit(
      OptionInfo{
          "smooth_colors", "",
          "Average neighbouring pixels of similar colour as far as that brings what is drawn "
          "closer to the colour camera's picture"},
      options.smooth_colors);
  visit(
      OptionInfo{"complete_sides", "",
                 "Complete the sides, seen by no RGB-D camera, of what stands on a table or floor"},
      options.complete_sides);
  visit(OptionInfo{"close_gaps", "",
                   "Show what an RGB-D camera sees without depth (black, shiny, in its projector's "
                   "shadow), where the colour camera's picture beside the objects confirms it"},
        options.close_gaps);
  visit(OptionInfo{"draw_bars", "",
                   "Draw steel pipes and other bars that depth sensors do not see, where an RGB-D "
                   "camera's picture shows them"},
        options.draw_bars);
  visit(
      OptionInfo{"lift_shadows", "", "Remove the shadows that the objects cast on what they hide"},
      options.lift_shadows);
  visit(OptionInfo{"refine_shadows", "",
                   "Make these shadows as deep, sharp and coloured as the picture shows them"},
        options.refine_shadows);
  visit(OptionInfo{"remove_shadows", "",
                   "Also remove the shadows that the objects cast outside their masks"},
        options.remove_shadows);
  visit(OptionInfo{"discontinuity_threshold_m", "metres",
                   "Largest depth step between pixels that a triangle may join (SDCT)", 1e-4, 100},
        options.discontinuity_threshold_m);
  visit(OptionInfo{"discontinuity_reach_m", "metres",
                   "Beyond this distance the threshold grows with its square, like a depth "
                   "sensor's steps; 0: constant, as in the paper",
                   0, 1000},
        options.discontinuity_reach_m);
  visit(OptionInfo{"depth_agreement_m", "metres",
                   "Surfaces of two RGB-D cameras closer than this count as one", 0, 100},
        options.depth_agreement_m);
  visit(OptionInfo{.name = "merge_cameras",
                   .unit = "method",
                   .help = "How the views of several RGB-D cameras are combined",
                   .choices = {"blend", "choose"}},
        options.merge_cameras);
  visit(OptionInfo{"surroundings_px", "pixels",
                   "How far around the masks the scene is reconstructed", 1, 10000},
        options.surroundings_px);
  visit(OptionInfo{"whole_view", "",
                   "Reconstruct the whole picture instead of the masks' surroundings"},
        options.whole_view);
  visit(OptionInfo{.name = "color_correct",
                   .unit = "method",
                   .help = "How the RGB-D cameras' colours are matched to the colour camera's",
                   .kind = "colour correction"},
        options.color_correct);
  visit(OptionInfo{.name = "memory",
                   .unit = "method",
                   .help = "What the cameras saw earlier: not shown, only where an RGB-D "
                           "camera sees that it is still there, or also where none looks now",
                   .choices = {"off", "witnessed", "on"}},
        options.memory);
  visit(OptionInfo{"memory_max_age_s", "seconds", "What was seen longer ago is forgotten", 0, 1e6},
        options.memory_max_age_s);
  visit(OptionInfo{.name = "inpaint",
                   .unit = "method",
                   .help = "How pixels that no RGB-D camera sees are filled",
                   .kind = "inpainting method"},
        options.inpaint);
  visit(OptionInfo{"inpaint_radius_px", "pixels", "Neighbourhood that telea and ns use", 1, 100},
        options.inpaint_radius_px);
  visit(OptionInfo{.name = "mode",
                   .unit = "method",
                   .help = "How the background is shown",
                   .kind = "view mode"},
        options.mode);
  visit(OptionInfo{"keep", "names", "Objects to leave in the picture, separated by commas"},
        options.keep);
  visit(OptionInfo{"transparency", "",
                   "Transparency of the object in mode half; 0: opaque, 1: invisible", 0, 1},
        options.transparency);
  visit(
      OptionInfo{.name = "on_doubt",
                 .unit = "method",
                 .help = "Where an RGB-D camera does not fit the picture: show the background and "
                         "say so, the camera's picture, or for half a second the last good one",
                 .choices = {"mark", "pass-through", "hold"}},
      options.on_doubt);
  visit(OptionInfo{"least_fit", "",
                   "Correlation of what an RGB-D camera sees with the picture below which it is "
                   "doubted; -1: never",
                   -1, 1},
        options.least_fit);
  visit(OptionInfo{.name = "backend",
                   .unit = "method",
                   .help = "Whether the CPU or the GPU makes the pixels, and how",
                   .kind = "reconstruction backend",
                   .choices = {"auto"}},
        options.backend);
}

/// Throws Error with the option and its value if the value is out of range or not a registered
/// method.
DIMINISH_EXPORT void check(const Options& options);

struct Rig;
struct Scene;
/// The same, and that the options fit the rig and the scene: the objects in `keep` exist, and there
/// is an RGB-D camera or a memory.
DIMINISH_EXPORT void check(const Options& options, const Rig& rig, const Scene& scene);

/// The texts that an option accepts, in the order in which they are offered; empty if it accepts
/// any.
DIMINISH_EXPORT std::vector<std::string> method_names(const std::string& option);
DIMINISH_EXPORT std::vector<std::string> method_names(const OptionInfo& option);

/// The names in `options.keep`.
DIMINISH_EXPORT std::vector<std::string> kept_objects(const Options& options);

}  // namespace diminish
