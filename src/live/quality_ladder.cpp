#include "live/quality_ladder.h"

#include <algorithm>
#include <array>
#include <string>

#include "diminish/color_corrector.h"
#include "diminish/inpainter.h"

namespace diminish {
namespace {

constexpr int frames_before_down = 3;
constexpr int least_patience = 30;
constexpr int most_patience = 960;
/// Below this share of the budget there is time to spare.
constexpr double well_below = 0.75;

/// What a method declares to be simpler than itself; else the method.
template <class Method>
std::string simpler(const std::string& name) {
  const char* const other = Registry<Method>::get(name)()->declaration().simpler;
  return other ? other : name;
}

struct Step {
  const char* description;
  void (*simplify)(Options&);
};

/// Each level includes those before it.
constexpr std::array<Step, 7> steps = {{
    {"whole view not reconstructed, shadows outside the mask stay",
     [](Options& o) {
       o.whole_view = false;
       o.remove_shadows = false;
     }},
    {"depth edges stay where they are", [](Options& o) { o.snap_edges = false; }},
    {"shadows not lifted", [](Options& o) { o.lift_shadows = false; }},
    {"invented pixels filled by a simpler method",
     [](Options& o) { o.inpaint = simpler<Inpainter>(o.inpaint); }},
    {"colours corrected by a simpler method",
     [](Options& o) { o.color_correct = simpler<ColorCorrector>(o.color_correct); }},
    {"poses not refined", [](Options& o) { o.refine_poses = false; }},
    {"depth not cleaned",
     [](Options& o) {
       o.smooth_depth = false;
       o.remove_flying = false;
       o.remove_hidden = false;
     }},
}};

}  // namespace

int QualityLadder::last_level() {
  return static_cast<int>(steps.size());
}

std::string QualityLadder::description(int level) {
  std::string text;
  for (int i = 0; i < level; ++i) {
    text += (i > 0 ? "; " : "") + std::string(steps[static_cast<std::size_t>(i)].description);
  }
  return text;
}

Options QualityLadder::simplified(const Options& options, int level) {
  Options simpler = options;
  for (int i = 0; i < level; ++i) steps[static_cast<std::size_t>(i)].simplify(simpler);
  return simpler;
}

void QualityLadder::change_level(int by) {
  level_ = std::clamp(level_ + by, 0, last_level());
  frames_over_ = frames_under_ = 0;
}

int QualityLadder::next_level(double frame_ms, double budget_ms) {
  if (budget_ms <= 0) {
    *this = {};
    return 0;
  }
  patience_ = std::clamp(patience_, least_patience, most_patience);
  ++frames_since_up_;
  frames_over_ = frame_ms > budget_ms ? frames_over_ + 1 : 0;
  frames_under_ = frame_ms < well_below * budget_ms ? frames_under_ + 1 : 0;
  if (frames_over_ >= frames_before_down && level_ < last_level()) {
    // A step up that did not hold is retried less and less often.
    patience_ = frames_since_up_ < 2 * least_patience ? std::min(2 * patience_, most_patience)
                                                      : least_patience;
    change_level(1);
  } else if (frames_under_ >= patience_ && level_ > 0) {
    change_level(-1);
    frames_since_up_ = 0;
  }
  return level_;
}

}  // namespace diminish
