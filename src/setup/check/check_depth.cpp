#include "setup/check/setup_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "core/robust.h"
#include "pose/depth_ratio.h"
#include "setup/check/check_focal_length.h"
#include "setup/check/flipped.h"

namespace diminish {
namespace {

using Severity = Finding::Severity;

// What counts as right: sensors, prints and calibrations are never exact.
constexpr double depth_tolerance = 0.04;  ///< of measured / computed depth
constexpr double largest_spread = 0.02;   ///< of depth over one marker
constexpr double unit_factor = 1.6;       ///< beyond this the depth unit is wrong, not the print

/// Measured / computed depth of a camera's markers, by id; depth_of gives the depth image.
template <class DepthOf>
std::map<int, DepthRatio> depth_ratios(const Diagnosis& setup, const Rig& rig, std::size_t camera,
                                       DepthOf&& depth_of) {
  std::map<int, std::vector<double>> ratios;
  std::map<int, std::vector<double>> spreads;
  for (const SetupSurvey::Kept& kept : setup.survey.kept) {
    if (!kept.frame.rgbd[camera].available()) continue;
    const InputImage<std::uint16_t> depth = depth_of(kept.frame);
    if (depth.width() != setup.rig.rgbd[camera].depth.width ||
        depth.height() != setup.rig.rgbd[camera].depth.height) {
      continue;
    }
    for (const Marker& marker : kept.markers.rgbd[camera]) {
      const auto size = setup.sizes.find(marker.id);
      if (size == setup.sizes.end()) continue;
      const auto ratio = measure_depth_ratio(marker, size->second, rig.rgbd[camera], depth);
      if (!ratio) continue;
      ratios[marker.id].push_back(ratio->ratio);
      spreads[marker.id].push_back(ratio->spread);
    }
  }
  std::map<int, DepthRatio> result;
  for (auto& [id, values] : ratios) result[id] = {median(values), median(spreads[id])};
  return result;
}

std::map<int, DepthRatio> depth_ratios(const Diagnosis& setup, const Rig& rig, std::size_t camera) {
  return depth_ratios(setup, rig, camera,
                      [=](const FrameSet& frame) { return frame.rgbd[camera].depth; });
}

bool is_right(const DepthRatio& measured) {
  return std::abs(measured.ratio - 1) <= depth_tolerance && measured.spread <= largest_spread;
}

bool all_right(const std::map<int, DepthRatio>& ratios) {
  return !ratios.empty() && std::all_of(ratios.begin(), ratios.end(),
                                        [](const auto& entry) { return is_right(entry.second); });
}

/// Finds depth that does not lie on the markers: another camera's, or mirrored.
bool check_foreign_depth(Diagnosis& setup, std::size_t k) {
  const std::string& name = setup.rig.rgbd[k].name;
  for (std::size_t other = 0; other < setup.rig.rgbd.size(); ++other) {
    if (other == k) continue;
    const auto swapped = depth_ratios(
        setup, setup.rig, k, [&](const FrameSet& frame) { return frame.rgbd[other].depth; });
    if (!all_right(swapped)) continue;
    setup.find(
        Severity::serious, "swapped",
        fmt::format("{} and {} are swapped: the depth of one belongs to the colour of the other",
                    name, setup.rig.rgbd[other].name),
        fmt::format("the depth of {} fits the markers in {}'s colour images, {}'s own does not",
                    setup.rig.rgbd[other].name, name, name),
        fmt::format("swap {}_depth.txt and {}_depth.txt, or the cameras' names in the driver", name,
                    setup.rig.rgbd[other].name));
    return true;
  }
  const auto mirrored = depth_ratios(setup, setup.rig, k, [&](const FrameSet& frame) {
    return flipped(frame.rgbd[k].depth.view());
  });
  if (!all_right(mirrored)) return false;
  setup.find(Severity::serious, "mirrored", name + " depth is mirrored",
             "the depth of its markers is right when the image is flipped left to right",
             "switch off mirroring in the driver");
  return true;
}

void blame_marker(Diagnosis& setup, int id, double ratio) {
  const double size = setup.sizes.at(id);
  setup.find(
      Severity::serious, "marker-size",
      fmt::format("marker {} is not {:.1f} mm wide, but {:.1f} mm according to its depth", id,
                  1000 * size, 1000 * size * ratio),
      fmt::format("measured / computed depth: {:.3f}", ratio),
      "measure the black square, without its white rim, and correct size_m in scene.yaml; print "
      "at 100 %");
  setup.sizes[id] = size * ratio;
  if (id == setup.scene.world_marker.id) setup.scene.world_marker.size_m *= ratio;
  setup.explained = true;
}

void blame_unit(Diagnosis& setup, std::size_t k, double ratio) {
  const double unit = setup.rig.rgbd[k].depth_unit_m;
  setup.find(
      Severity::serious, "depth-unit",
      fmt::format("{}'s depth_unit_m is wrong by a factor of {:.3g}", setup.rig.rgbd[k].name,
                  ratio),
      fmt::format("its markers are {:.3g} times as far away by depth as by their size", ratio),
      fmt::format("depth_unit_m: {:.4g} in rig.yaml, instead of {:.4g} (the driver's documents say "
                  "the exact one)",
                  unit / ratio, unit));
  setup.rig.rgbd[k].depth_unit_m = unit / ratio;
  setup.explained = true;
}

/// The factor on the focal length of an RGB-D camera's colour sensor that makes the depth of all
/// its markers right, if there is one.
std::optional<double> explaining_focal_length(const Diagnosis& setup, std::size_t camera) {
  std::optional<double> best;
  double best_error = std::numeric_limits<double>::infinity();
  for (int percent = 80; percent <= 125; ++percent) {
    const double factor = percent / 100.0;
    const auto ratios =
        depth_ratios(setup, with_focal_length(setup.rig, camera + 1, factor), camera);
    if (!all_right(ratios)) continue;
    double error = 0;
    for (const auto& [id, measured] : ratios) error += std::abs(measured.ratio - 1);
    if (error / static_cast<double>(ratios.size()) >= best_error) continue;
    best_error = error / static_cast<double>(ratios.size());
    best = factor;
  }
  return best;
}

/// All markers in all cameras are too near or too far: the print, the depth unit or the focal
/// length is wrong.
void check_common_ratio(Diagnosis& setup, const std::vector<std::map<int, DepthRatio>>& ratios,
                        const std::map<int, std::vector<double>>& by_marker) {
  std::vector<double> all;
  for (const auto& [id, values] : by_marker) all.insert(all.end(), values.begin(), values.end());
  const double ratio = median_of(all);
  std::vector<std::size_t> cameras;
  for (std::size_t k = 0; k < ratios.size(); ++k) {
    if (!ratios[k].empty()) cameras.push_back(k);
  }
  if (ratio > unit_factor || ratio < 1 / unit_factor) {
    for (const std::size_t k : cameras) blame_unit(setup, k, ratio);
    return;
  }
  if (cameras.size() == 1) {
    if (const auto factor = explaining_focal_length(setup, cameras[0])) {
      Scene scaled = setup.scene;
      const auto world = by_marker.find(setup.scene.world_marker.id);
      if (world != by_marker.end()) scaled.world_marker.size_m *= median_of(world->second);
      const auto by_size = agreement(setup, setup.rig, scaled);
      const auto by_focal_length =
          agreement(setup, with_focal_length(setup.rig, cameras[0] + 1, *factor), setup.scene);
      if (by_size && by_focal_length && *by_focal_length > *by_size + least_improvement) {
        blame_focal_length(setup, cameras[0] + 1, *factor,
                           fmt::format("so the pictures of both cameras agree by {:.2f}, with "
                                       "markers of another size by {:.2f}",
                                       *by_focal_length, *by_size));
        return;
      }
    }
  }
  for (const auto& [id, values] : by_marker) blame_marker(setup, id, median_of(values));
}

/// One camera is wrong: other cameras say that the markers are right.
void check_one_cameras_depth(Diagnosis& setup, std::size_t k,
                             const std::map<int, DepthRatio>& ratios,
                             const std::set<int>& wrong_markers) {
  std::vector<double> wrong;
  for (const auto& [id, measured] : ratios) {
    if (wrong_markers.count(id) > 0) continue;
    if (std::abs(measured.ratio - 1) > depth_tolerance) wrong.push_back(measured.ratio);
  }
  if (wrong.empty()) return;
  const double ratio = median_of(wrong);
  if (ratio > unit_factor || ratio < 1 / unit_factor) return blame_unit(setup, k, ratio);
  blame_focal_length(
      setup, k + 1, ratio,
      fmt::format("its markers are {:.3f} times as far away by depth as by their size, in other "
                  "cameras they are right",
                  ratio));
}

}  // namespace

void check_depth(Diagnosis& setup) {
  std::vector<std::map<int, DepthRatio>> ratios(setup.rig.rgbd.size());
  for (std::size_t k = 0; k < setup.rig.rgbd.size(); ++k) {
    if (setup.usable[k]) ratios[k] = depth_ratios(setup, setup.rig, k);
    for (const auto& [id, measured] : ratios[k]) {
      setup.note(
          fmt::format("{}: depth of marker {}, measured / computed", setup.rig.rgbd[k].name, id),
          measured.ratio, "");
    }
  }
  for (std::size_t k = 0; k < setup.rig.rgbd.size(); ++k) {
    if (ratios[k].empty() || all_right(ratios[k]) || !check_foreign_depth(setup, k)) continue;
    setup.usable[k] = false;
    ratios[k].clear();
  }
  // A marker that is wrong where others are right: its size. The others' ratio: the camera's.
  std::map<int, std::vector<double>> by_marker;
  for (const auto& camera : ratios) {
    for (const auto& [id, measured] : camera) by_marker[id].push_back(measured.ratio);
  }
  std::set<int> wrong_markers;
  for (const auto& [id, values] : by_marker) {
    const bool wrong_everywhere = std::all_of(values.begin(), values.end(), [](double ratio) {
      return std::abs(ratio - 1) > depth_tolerance;
    });
    if (wrong_everywhere) wrong_markers.insert(id);
  }
  const bool all_wrong = wrong_markers.size() == by_marker.size();
  if (!wrong_markers.empty() && !all_wrong) {
    for (const int id : wrong_markers) blame_marker(setup, id, median_of(by_marker[id]));
  } else if (all_wrong && !by_marker.empty()) {
    check_common_ratio(setup, ratios, by_marker);
  }
  for (std::size_t k = 0; k < setup.rig.rgbd.size(); ++k)
    check_one_cameras_depth(setup, k, ratios[k], wrong_markers);
}

}  // namespace diminish
