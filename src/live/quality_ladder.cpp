#include "live/quality_ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/robust.h"
#include "diminish/color_corrector.h"
#include "diminish/inpainter.h"

namespace diminish {
namespace {

constexpr int frames_before_up = 30;
/// A step up must be expected to fit in this share of the budget.
constexpr double room = 0.9;
/// Limits of what a step is believed to save.
constexpr double least_cost = 1.05;
constexpr double most_cost = 2.5;
/// Other programs that came or went may have been what a step seemed to save. So half of it is
/// forgotten in 23 s (at 30 frames/s); at last the step up is tried again.
constexpr double remembered = 0.999;

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

/// Each level includes those before it. The least visible comes first, and each must save time
/// (bench/quality_ladder_bench.cpp).
constexpr std::array<Step, QualityLadder::last_level> steps = {{
    {"whole view not reconstructed, shadows outside the mask stay",
     [](Options& o) {
       o.whole_view = false;
       o.remove_shadows = false;
     }},
    {"depth edges stay where they are", [](Options& o) { o.snap_edges = false; }},
    {"simpler colours, one RGB-D camera per pixel",
     [](Options& o) {
       o.color_correct = simpler<ColorCorrector>(o.color_correct);
       o.inpaint = simpler<Inpainter>(o.inpaint);
       o.complete_sides = false;
       o.draw_bars = false;
       o.close_gaps = false;
       o.smooth_colors = false;
       o.merge_cameras = "choose";
     }},
    {"shadows not lifted", [](Options& o) { o.lift_shadows = false; }},
    {"poses not refined, depth not cleaned, nothing remembered",
     [](Options& o) {
       o.memory = "off";
       o.refine_poses = false;
       o.smooth_depth = false;
       o.remove_flying = false;
       o.remove_hidden = false;
     }},
}};

bool are_same(const Options& a, const Options& b) {
  const auto text_of = [](const Options& options) {
    std::string text;
    for_each_option(
        options, [&](const OptionInfo&, const auto& value) { text += fmt::format("{};", value); });
    return text;
  };
  return text_of(a) == text_of(b);
}

/// Whether a level is another than the one before it.
bool changes(const Options& options, int level) {
  return !are_same(QualityLadder::simplified(options, level),
                   QualityLadder::simplified(options, level - 1));
}

}  // namespace

std::string QualityLadder::description(const Options& options, int level) {
  std::string text;
  for (int i = 1; i <= level; ++i) {
    if (!changes(options, i)) continue;
    text += (text.empty() ? "" : "; ") +
            std::string(steps[static_cast<std::size_t>(i - 1)].description);
  }
  return text;
}

Options QualityLadder::simplified(const Options& options, int level) {
  Options simpler = options;
  for (int i = 0; i < level; ++i) steps[static_cast<std::size_t>(i)].simplify(simpler);
  return simpler;
}

void QualityLadder::change_level(int by, const Options& options) {
  int level = level_;
  do {
    if (by > 0 && level == last_level) return;  // no further level changes anything
    level += by;
  } while (level > 0 && !changes(options, level));
  level_ = level;
  times_ms_.clear();
  frames_under_ = 0;
}

int QualityLadder::next_level(double frame_ms, double budget_ms, const Options& options) {
  if (budget_ms <= 0) {
    *this = {};
    return 0;
  }
  double& cost = costs_[static_cast<std::size_t>(level_)];
  cost = std::max(1 + (cost - 1) * remembered, least_cost);
  times_ms_.add(frame_ms);
  if (!times_ms_.full()) return level_;
  std::vector<double> times = times_ms_.values();
  const double usual_ms = median(times);
  if (has_stepped_down_) cost = std::clamp(ms_before_ / usual_ms, least_cost, most_cost);
  has_stepped_down_ = false;
  frames_under_ = usual_ms * cost < room * budget_ms ? frames_under_ + 1 : 0;
  if (usual_ms > budget_ms) {
    const int before = level_;
    change_level(1, options);
    has_stepped_down_ = level_ != before;
    ms_before_ = usual_ms;
  } else if (frames_under_ >= frames_before_up && level_ > 0) {
    change_level(-1, options);
  }
  return level_;
}

}  // namespace diminish
