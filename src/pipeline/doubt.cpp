#include "pipeline/doubt.h"

#include <algorithm>

namespace diminish {
namespace {

bool shows_doubtful(const DiminishedFrame& result) {
  return result.report.in_doubt && !result.objects.empty();
}

void show_camera(const FrameSet& frame, DiminishedFrame& result) {
  copy(frame.color.view(), result.picture);
  const Rect objects = intersect(result.objects, result.provenance.bounds());
  result.provenance.fill(objects, provenance::camera);
}

}  // namespace

void Doubt::judge(const Rig& rig, const Options& options, FrameReport& report) {
  for (std::size_t k = 0; k < report.fit.size(); ++k) {
    if (!report.fit[k] || *report.fit[k] >= options.least_fit) continue;
    report.in_doubt = true;
    report.messages.push_back(rig.rgbd[k].name +
                              ": what it sees does not fit the picture: has it moved, is it late, "
                              "or is its calibration wrong?");
  }
}

bool Doubt::act(const FrameSet& frame, const Options& options, DiminishedFrame& result) {
  if (options.on_doubt == "hold") return hold(frame, result);
  if (!shows_doubtful(result) || options.on_doubt == "mark") return false;
  show_camera(frame, result);
  return true;
}

bool Doubt::hold(const FrameSet& frame, DiminishedFrame& result) {
  turn_.wait(shared_->turns);
  const struct End {
    Turn& turn;
    ~End() { turn.end(); }
  } end{turn_};
  Shared& held = *shared_;
  if (!shows_doubtful(result)) {
    held.stamp_s = frame.stamp_s;
    held.picture = result.picture;
    held.mask = result.mask;
    held.provenance = result.provenance;
    held.objects = result.objects;
    return false;
  }
  const double age_s = frame.stamp_s - held.stamp_s;
  if (held.picture.empty() || age_s < 0 || age_s > longest_hold_s) {
    show_camera(frame, result);
    return true;
  }
  result.picture = held.picture;
  result.mask = held.mask;
  result.provenance = held.provenance;
  result.objects = held.objects;
  return true;
}

void Doubt::forget() {
  turn_.wait(shared_->turns);
  shared_->picture = {};
  turn_.end();
}

}  // namespace diminish
