#include "serve/advice.h"

#include <array>
#include <string_view>

namespace diminish {
namespace {

struct Advice {
  std::string_view in_problem;
  std::string_view to_do;
};

// The first that fits.
constexpr std::array known = {
    Advice{": camera lost: ",
           "check its cable and power, and that no other program uses it. It is tried again and "
           "again; nothing needs a restart"},
    Advice{": the camera is silent: ",
           "check its cable, and that its USB bus is not shared with another camera. It goes on "
           "as soon as images come"},
    Advice{"no new picture", "see below under Cameras which one does not run"},
    Advice{" image within ",
           "this camera is late or slower than the user's: diminish sync-check measures by how "
           "much, --sync-tolerance-s allows more"},
    Advice{"a frame takes ", "wait; if it does not end, start diminish again with fewer cameras"},
    Advice{"the last frame failed: ",
           "the next frame is tried. If it fails, too, start diminish again and report the text"},
    Advice{"world marker ",
           "turn the camera or move what hides the marker until all of its black square is in "
           "view, at least 40 pixels wide"},
    Advice{" not visible in any camera",
           "show the object's marker to a camera: whole, sharp, at least 40 pixels wide"},
    Advice{" not visible in ",
           "turn the object, or add a marker on another side of it (scene.yaml)"},
    Advice{": no blob of its colour",
           "bring the object into view; after a change of light, train its colour anew: diminish "
           "train-color"},
    Advice{"no RGB-D camera sees",
           "turn or move an RGB-D camera until it sees the place behind the object"},
    Advice{": no joint positions within ", "start what sends the robot's joint positions"},
    Advice{": no mask for ", "start what sends the masks"},
};

}  // namespace

std::string advice_for(const std::string& problem) {
  for (const Advice& advice : known) {
    if (problem.find(advice.in_problem) != std::string::npos) return std::string(advice.to_do);
  }
  return {};
}

}  // namespace diminish
