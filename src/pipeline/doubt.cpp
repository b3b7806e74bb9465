#include "pipeline/doubt.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace diminish {
namespace {

bool shows_doubtful(const DiminishedFrame& result) {
  return result.report.in_doubt && !result.objects.empty();
}

bool is_wrong(const MarkerScale& scale) {
  return scale.ratio > 1 + DepthScale::tolerance || scale.ratio < 1 / (1 + DepthScale::tolerance);
}

bool is_wrong(const MarkerShift& shift) {
  return shift.shift > MarkerAgreement::tolerance;
}

void doubt(std::string message, FrameReport& report) {
  report.in_doubt = true;
  report.messages.push_back(std::move(message));
}

std::string wrong_scale(const RgbdCamera& camera, const MarkerScale& scale) {
  return fmt::format(
      "{}: marker {} is {:.3g} times as far away by depth as by its size: correct size_m (measure "
      "the black square) or depth_unit_m; diminish check says which",
      camera.name, scale.marker, scale.ratio);
}

std::string wrong_place(const RgbdCamera& camera, const MarkerShift& shift) {
  return fmt::format(
      "color: marker {} is {:.1f} degrees beside where {} locates it: is the colour camera's "
      "calibration its own (diminish calibrate intrinsics), size_m right, {} late? diminish check "
      "says which",
      shift.marker, shift.shift * 180 / std::numbers::pi, camera.name, camera.name);
}

std::string not_there(const RgbdCamera& camera, const PlaceOfObject& place) {
  return fmt::format(
      "color: the object with marker {} is not where it locates it, by what {} measures there: is "
      "size_m right (measure the black square), the colour camera's calibration its own, {} late? "
      "diminish check",
      place.marker, camera.name, camera.name);
}

std::string wrong_lens(double factor) {
  return fmt::format(
      "color: a focal length that is {:.0f} % {} explains the picture better. Is its calibration "
      "its "
      "own, with this zoom and focus? diminish calibrate intrinsics",
      100 * std::abs(factor - 1), factor > 1 ? "larger" : "smaller");
}

std::string late(const RgbdCamera& camera, double late_s) {
  return fmt::format(
      "{}: what moves is seen where it was {:.2f} s before: its images are late, or their "
      "timestamps wrong. diminish sync-check measures the delay",
      camera.name, late_s);
}

std::string no_fit(const std::string& camera) {
  return camera +
         ": what it sees does not fit the picture. Has it moved? diminish calibrate rig --repair. "
         "Is it late, or its calibration another's? diminish check";
}

void show_camera(const FrameSet& frame, DiminishedFrame& result) {
  copy(frame.color.view(), result.picture);
  const Rect objects = intersect(result.objects, result.provenance.bounds());
  result.provenance.fill(objects, provenance::camera);
}

}  // namespace

void Doubt::judge(const Rig& rig, const Options& options, const Evidence& evidence,
                  FrameReport& report) {
  if (options.least_fit <= -1) return;
  // A wrong scale looks like a wrong lens, too.
  const bool is_scale_wrong =
      std::any_of(evidence.scales.begin(), evidence.scales.end(),
                  [](const auto& scale) { return scale && is_wrong(*scale); });
  if (evidence.focal_factor && !is_scale_wrong) doubt(wrong_lens(*evidence.focal_factor), report);
  for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
    const auto& scale = evidence.scales[k];
    const auto& shift = evidence.shifts[k];
    const auto& place = evidence.places[k];
    // What explains more comes first: a wrong scale spoils the fit, too.
    if (scale && is_wrong(*scale)) {
      doubt(wrong_scale(rig.rgbd[k], *scale), report);
    } else if (shift && is_wrong(*shift)) {
      doubt(wrong_place(rig.rgbd[k], *shift), report);
    } else if (place && place->is_wrong()) {
      doubt(not_there(rig.rgbd[k], *place), report);
    } else if (evidence.late_s[k]) {
      doubt(late(rig.rgbd[k], *evidence.late_s[k]), report);
    } else if (k < report.fit.size() && report.fit[k] && *report.fit[k] < options.least_fit) {
      doubt(no_fit(rig.rgbd[k].name), report);
    }
  }
}

void Doubt::judge_background(const std::optional<double>& fit, const Options& options,
                             FrameReport& report) {
  if (!fit || *fit >= options.least_fit) return;
  doubt(
      "the background (diminish scan) does not fit the picture: is it another room's, or has this "
      "one changed? diminish scan",
      report);
}

bool Doubt::act(const FrameSet& frame, const Options& options, DiminishedFrame& result) {
  if (options.on_doubt == "hold") return hold(frame, result);
  if (!shows_doubtful(result) || options.on_doubt == "mark") return false;
  show_camera(frame, result);
  return true;
}

bool Doubt::hold(const FrameSet& frame, DiminishedFrame& result) {
  const Turn::Held turn = turn_.hold(shared_->turns);
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
  const Turn::Held turn = turn_.hold(shared_->turns);
  shared_->picture = {};
}

}  // namespace diminish
