#include "diminish/setup_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>

#include "core/mat.h"
#include "core/robust.h"
#include "pose/camera_poses.h"
#include "pose/known_markers.h"
#include "pose/marker_dictionary.h"
#include "setup/clock_offset.h"
#include "setup/depth_ratio.h"
#include "setup/photometric_agreement.h"
#include "setup/setup_survey.h"

namespace diminish {
namespace {

using Severity = Finding::Severity;

// What is taken for right. Sensors, prints and calibrations are never exact.
constexpr double depth_tolerance = 0.04;  ///< of measured by computed depth
constexpr double largest_spread = 0.02;   ///< of depth over one marker
constexpr double unit_factor = 1.6;       ///< beyond this it is the depth's unit, not a print
constexpr double least_improvement =
    0.04;                                ///< of the pictures' correlation, to blame a focal length
constexpr double least_agreement = 0.4;  ///< below that the pictures do not agree at all
constexpr double focal_tolerance = 0.04;
constexpr double small_marker_px = 40;
constexpr double dark_level = 35;
constexpr double overexposed_share = 0.2;

double median_of(std::vector<double> values) {
  return values.empty() ? 0 : median(values);
}

template <class Pixel>
Image<Pixel> flipped(const Image<Pixel>& image) {
  Image<Pixel> result(image.width(), image.height());
  cv::Mat mat = as_mat(result);
  cv::flip(as_mat(image), mat, 1);
  return result;
}

/// The rig with a colour sensor's focal length times a factor; sensor 0 is the colour camera.
Rig with_focal_length(Rig rig, std::size_t sensor, double factor) {
  Intrinsics& camera = sensor == 0 ? rig.color : rig.rgbd[sensor - 1].color;
  camera.fx *= factor;
  camera.fy *= factor;
  return rig;
}

class Checker {
 public:
  Checker(const Rig& rig, const Scene& scene, SetupSurvey survey)
      : rig_(rig), scene_(scene), survey_(std::move(survey)), sizes_(known_marker_sizes(scene)) {
    report_.frames = survey_.frames;
    usable_.assign(rig.rgbd.size(), true);
  }

  SetupReport run() {
    check_streams();
    check_exposure();
    check_markers();
    check_depth();
    // Fixed poses are either right or explain what follows; those from markers depend on all else.
    const bool fixed = rig_.pose_source == "fixed";
    if (fixed) check_between_cameras();
    check_focal_length();
    check_clocks();
    if (!fixed) check_between_cameras();
    std::stable_sort(report_.findings.begin(), report_.findings.end(),
                     [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
    return std::move(report_);
  }

 private:
  void find(Severity severity, std::string code, std::string what, std::string figure,
            std::string remedy) {
    report_.findings.push_back(
        {severity, std::move(code), std::move(what), std::move(figure), std::move(remedy)});
  }
  void note(std::string name, double value, std::string unit) {
    report_.figures.push_back({std::move(name), value, std::move(unit)});
  }
  /// "color", "rgbd0 color".
  std::vector<const SensorSurvey*> sensors() const {
    std::vector<const SensorSurvey*> all = {&survey_.color};
    for (const SensorSurvey& sensor : survey_.rgbd) all.push_back(&sensor);
    return all;
  }

  void check_streams() {
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      const std::string& name = rig_.rgbd[k].name;
      const std::size_t missing = survey_.missing[k];
      note(name + ": frames with its images", static_cast<double>(survey_.frames - missing), "");
      if (10 * missing <= survey_.frames) continue;
      const bool none = 2 * missing > survey_.frames;
      if (missing == survey_.frames) usable_[k] = false;
      find(none ? Severity::serious : Severity::warning, "no-partner",
           fmt::format("{} of {} frames go without {}", missing, survey_.frames, name),
           survey_.first_missing[k],
           "synchronise the clocks, or shift the timestamps in its lists; if it is only a little, "
           "raise --sync-tolerance-s");
    }
    if (survey_.fault_count > 0) {
      find(Severity::warning, "faults",
           fmt::format("{} images could not be used", survey_.fault_count), survey_.faults.front(),
           "record again, or see what damages the files");
    }
  }

  void check_exposure() {
    for (const SensorSurvey* sensor : sensors()) {
      if (sensor->images == 0) continue;
      const double level = median_of(sensor->brightness);
      const double over = median_of(sensor->overexposed);
      note(sensor->name + ": brightness", level, "levels");
      if (level < dark_level) {
        find(Severity::warning, "dark", sensor->name + " is too dark",
             fmt::format("mean brightness {:.0f} of 255", level),
             "more light, a longer exposure or a larger aperture");
      }
      if (over > overexposed_share) {
        find(Severity::warning, "overexposed", sensor->name + " is overexposed",
             fmt::format("{:.0f} % of its pixels are white", 100 * over),
             "a shorter exposure, or less light");
      }
    }
  }

  bool sees_known_markers(const SensorSurvey& sensor) const { return !sensor.markers.empty(); }

  const Image<Bgr>& image_of(const SetupSurvey::Kept& kept, std::size_t sensor) const {
    return sensor == 0 ? kept.frame.color : kept.frame.rgbd[sensor - 1].color;
  }

  void check_markers() {
    if (sizes_.empty()) return;
    const auto all = sensors();
    const bool any = std::any_of(all.begin(), all.end(), [&](const SensorSurvey* sensor) {
      return sees_known_markers(*sensor);
    });
    std::set<std::size_t> mirrored;
    for (std::size_t s = 0; s < all.size(); ++s) {
      if (all[s]->images == 0 || sees_known_markers(*all[s]) || !check_mirrored(s)) continue;
      mirrored.insert(s);
      mark_unusable(s);
    }
    if (!any && mirrored.empty()) {
      for (std::size_t s = 0; s < all.size(); ++s) mark_unusable(s);
      if (check_dictionary()) return;
    }
    const bool needs_world = rig_.pose_source == "marker" && scene_.world_marker.size_m > 0;
    for (std::size_t s = 0; s < all.size(); ++s) {
      if (all[s]->images == 0 || mirrored.count(s) > 0) continue;
      if (needs_world) check_world_marker(*all[s], s);
      check_marker_sizes(*all[s]);
    }
    for (const auto& [id, size] : sizes_) {
      if (needs_world && id == scene_.world_marker.id) continue;
      const bool seen = std::any_of(all.begin(), all.end(), [&, marker = id](const auto* sensor) {
        return sensor->markers.count(marker) > 0;
      });
      if (seen || !mirrored.empty()) continue;
      find(Severity::serious, "marker-not-visible",
           fmt::format("marker {} is never visible, in no camera", id),
           fmt::format("0 of {} frames", survey_.frames),
           "check its id, that it is whole and in view, and its white rim");
    }
  }

  void mark_unusable(std::size_t sensor) {
    if (sensor == 0) {
      std::fill(usable_.begin(), usable_.end(), false);
    } else {
      usable_[sensor - 1] = false;
    }
  }

  bool check_mirrored(std::size_t sensor) {
    MarkerDetector detector(scene_.marker_dictionary);
    const Lens lens(sensor == 0 ? rig_.color : rig_.rgbd[sensor - 1].color);
    std::vector<Marker> markers;
    std::size_t found = 0;
    std::size_t images = 0;
    for (const SetupSurvey::Kept& kept : survey_.kept) {
      if (image_of(kept, sensor).empty()) continue;
      ++images;
      detector.detect(flipped(image_of(kept, sensor)), lens, markers);
      const bool known = std::any_of(markers.begin(), markers.end(), [&](const Marker& marker) {
        return sizes_.count(marker.id) > 0;
      });
      found += known ? 1 : 0;
    }
    if (found == 0 || 2 * found < images) return false;
    find(Severity::serious, "mirrored", sensors()[sensor]->name + " is mirrored",
         fmt::format("markers are found in {} of {} images, but only when these are flipped left "
                     "to right",
                     found, images),
         "switch mirroring off in the driver; of an RGB-D camera check the depth images, too");
    return true;
  }

  /// Looks for other dictionaries' markers where none of the configured one was found.
  bool check_dictionary() {
    std::string best;
    std::size_t best_score = 0;
    std::string ids;
    for (const std::string& name : dictionary_names()) {
      MarkerDetector detector(name);
      std::map<int, std::size_t> seen;
      for (const SetupSurvey::Kept& kept : survey_.kept) {
        for (std::size_t s = 0; s <= rig_.rgbd.size(); ++s) {
          if (image_of(kept, s).empty()) continue;
          const Lens lens(s == 0 ? rig_.color : rig_.rgbd[s - 1].color);
          std::vector<Marker> markers;
          detector.detect(image_of(kept, s), lens, markers);
          for (const Marker& marker : markers) ++seen[marker.id];
        }
      }
      // What is there is seen again; the ids that are expected count double.
      std::size_t score = 0;
      std::string list;
      for (const auto& [id, count] : seen) {
        if (count < 2) continue;
        score += count * (sizes_.count(id) > 0 ? 2 : 1);
        list += (list.empty() ? "" : ", ") + std::to_string(id);
      }
      if (score <= best_score) continue;
      best_score = score;
      best = name;
      ids = list;
    }
    if (best.empty() || best == scene_.marker_dictionary) return false;
    find(Severity::serious, "dictionary",
         fmt::format("the markers are of another dictionary: {}", best),
         fmt::format("none of {} is found, but of {} ids {}", scene_.marker_dictionary, best, ids),
         fmt::format("marker_dictionary: {} in scene.yaml", best));
    return true;
  }

  void check_world_marker(const SensorSurvey& sensor, std::size_t index) {
    const int id = scene_.world_marker.id;
    const auto statistics = sensor.markers.find(id);
    const std::size_t count = statistics == sensor.markers.end() ? 0 : statistics->second.count;
    note(fmt::format("{}: frames with the world marker", sensor.name), static_cast<double>(count),
         "");
    if (2 * count >= sensor.images) return;
    if (count == 0) {
      mark_unusable(index);
      if (check_too_small(sensor, index, id)) return;
    }
    find(count == 0 ? Severity::serious : Severity::warning, "marker-not-visible",
         fmt::format("world marker {} is {} visible in {}", id, count == 0 ? "never" : "seldom",
                     sensor.name),
         fmt::format("{} of {} frames", count, sensor.images),
         "turn the camera or move the marker until every camera sees all of it; check its id and "
         "its white rim");
  }

  /// Markers that are too small for the detector, but not for OpenCV's, which takes its time.
  bool check_too_small(const SensorSurvey& sensor, std::size_t index, int id) {
    std::vector<double> sides;
    for (const SetupSurvey::Kept& kept : survey_.kept) {
      if (image_of(kept, index).empty()) continue;
      std::vector<std::vector<cv::Point2f>> corners;
      std::vector<int> ids;
      cv::aruco::detectMarkers(as_mat(image_of(kept, index)),
                               find_dictionary(scene_.marker_dictionary), corners, ids);
      for (std::size_t i = 0; i < ids.size(); ++i) {
        if (ids[i] == id) sides.push_back(cv::arcLength(corners[i], true) / 4);
      }
    }
    if (sides.empty()) return false;
    find(Severity::serious, "marker-small",
         fmt::format("world marker {} is too small in {}", id, sensor.name),
         fmt::format("{:.0f} pixels; expected {:.0f} and more", median_of(sides), small_marker_px),
         "print it larger, or bring it nearer");
    return true;
  }

  void check_marker_sizes(const SensorSurvey& sensor) {
    for (const auto& [id, statistics] : sensor.markers) {
      const double side = median_of(statistics.sides_px);
      note(fmt::format("{}: side of marker {}", sensor.name, id), side, "pixels");
      note(fmt::format("{}: reprojection error of marker {}", sensor.name, id),
           median_of(statistics.errors_px), "pixels");
      if (side >= small_marker_px) continue;
      find(Severity::warning, "marker-small",
           fmt::format("marker {} is small in {}", id, sensor.name),
           fmt::format("{:.0f} pixels; expected {:.0f} and more", side, small_marker_px),
           "print it larger, or bring it nearer");
    }
  }

  /// Measured by computed depth of a camera's markers, by id; depth_of gives the depth image.
  template <class DepthOf>
  std::map<int, DepthRatio> depth_ratios(const Rig& rig, std::size_t camera,
                                         DepthOf&& depth_of) const {
    std::map<int, std::vector<double>> ratios;
    std::map<int, std::vector<double>> spreads;
    for (const SetupSurvey::Kept& kept : survey_.kept) {
      if (!kept.frame.rgbd[camera].available()) continue;
      const Image<std::uint16_t> depth = depth_of(kept.frame);
      if (depth.width() != rig_.rgbd[camera].depth.width ||
          depth.height() != rig_.rgbd[camera].depth.height) {
        continue;
      }
      for (const Marker& marker : kept.markers.rgbd[camera]) {
        const auto size = sizes_.find(marker.id);
        if (size == sizes_.end()) continue;
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
  std::map<int, DepthRatio> depth_ratios(const Rig& rig, std::size_t camera) const {
    return depth_ratios(rig, camera,
                        [=](const FrameSet& frame) { return frame.rgbd[camera].depth; });
  }

  static bool is_right(const DepthRatio& measured) {
    return std::abs(measured.ratio - 1) <= depth_tolerance && measured.spread <= largest_spread;
  }
  static bool all_right(const std::map<int, DepthRatio>& ratios) {
    return !ratios.empty() && std::all_of(ratios.begin(), ratios.end(),
                                          [](const auto& entry) { return is_right(entry.second); });
  }

  void check_depth() {
    std::vector<std::map<int, DepthRatio>> ratios(rig_.rgbd.size());
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      if (usable_[k]) ratios[k] = depth_ratios(rig_, k);
      for (const auto& [id, measured] : ratios[k]) {
        note(fmt::format("{}: depth of marker {}, measured by computed", rig_.rgbd[k].name, id),
             measured.ratio, "");
      }
    }
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      if (ratios[k].empty() || all_right(ratios[k]) || !check_foreign_depth(k)) continue;
      usable_[k] = false;
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
      for (const int id : wrong_markers) blame_marker(id, median_of(by_marker[id]));
    } else if (all_wrong && !by_marker.empty()) {
      check_common_ratio(ratios, by_marker);
    }
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k)
      check_one_cameras_depth(k, ratios[k], wrong_markers);
  }

  /// Depth that does not lie on the markers: another camera's, or mirrored.
  bool check_foreign_depth(std::size_t k) {
    const std::string& name = rig_.rgbd[k].name;
    for (std::size_t other = 0; other < rig_.rgbd.size(); ++other) {
      if (other == k) continue;
      const auto swapped =
          depth_ratios(rig_, k, [&](const FrameSet& frame) { return frame.rgbd[other].depth; });
      if (!all_right(swapped)) continue;
      find(
          Severity::serious, "swapped",
          fmt::format("{} and {} are swapped: the depth of one belongs to the colour of the other",
                      name, rig_.rgbd[other].name),
          fmt::format("the depth of {} fits the markers in {}'s colour images, {}'s own does not",
                      rig_.rgbd[other].name, name, name),
          fmt::format("exchange {}_depth.txt and {}_depth.txt, or the cameras' names in the driver",
                      name, rig_.rgbd[other].name));
      return true;
    }
    const auto mirrored =
        depth_ratios(rig_, k, [&](const FrameSet& frame) { return flipped(frame.rgbd[k].depth); });
    if (!all_right(mirrored)) return false;
    find(Severity::serious, "mirrored", name + " depth is mirrored",
         "the depth of its markers is right when the image is flipped left to right",
         "switch mirroring off in the driver");
    return true;
  }

  void blame_marker(int id, double ratio) {
    const double size = sizes_.at(id);
    find(Severity::serious, "marker-size",
         fmt::format("marker {} is not {:.1f} mm wide, but {:.1f} mm by the depth measured on it",
                     id, 1000 * size, 1000 * size * ratio),
         fmt::format("measured by computed depth {:.3f}", ratio),
         "measure the black square, without its white rim, and correct size_m in scene.yaml; print "
         "at 100 %");
    sizes_[id] = size * ratio;
    if (id == scene_.world_marker.id) scene_.world_marker.size_m *= ratio;
    explained_ = true;
  }

  void blame_unit(std::size_t k, double ratio) {
    const double unit = rig_.rgbd[k].depth_unit_m;
    find(Severity::serious, "depth-unit",
         fmt::format("{}'s depth_unit_m is wrong by a factor of {:.3g}", rig_.rgbd[k].name, ratio),
         fmt::format("its markers are {:.3g} times as far away by depth as by their size", ratio),
         fmt::format(
             "depth_unit_m: {:.4g} in rig.yaml, instead of {:.4g} (the driver's documents say "
             "the exact one)",
             unit / ratio, unit));
    rig_.rgbd[k].depth_unit_m = unit / ratio;
    explained_ = true;
  }

  void blame_focal_length(std::size_t sensor, double factor, const std::string& figure) {
    const Intrinsics& camera = sensor == 0 ? rig_.color : rig_.rgbd[sensor - 1].color;
    find(Severity::serious, "intrinsics",
         fmt::format("the focal length of {} is wrong: about {:.0f} pixels rather than {:.0f}",
                     sensors()[sensor]->name, camera.fx * factor, camera.fx),
         figure,
         fmt::format("diminish calibrate intrinsics --camera {}",
                     sensor == 0 ? "color" : rig_.rgbd[sensor - 1].name + "_color"));
    rig_ = with_focal_length(rig_, sensor, factor);
    explained_ = true;
  }

  /// The factor of the focal length of an RGB-D camera's colour sensor with which the depth of all
  /// its markers is right, if there is one.
  std::optional<double> explaining_focal_length(std::size_t camera) const {
    std::optional<double> best;
    double best_error = std::numeric_limits<double>::infinity();
    for (int percent = 80; percent <= 125; ++percent) {
      const double factor = percent / 100.0;
      const auto ratios = depth_ratios(with_focal_length(rig_, camera + 1, factor), camera);
      if (!all_right(ratios)) continue;
      double error = 0;
      for (const auto& [id, measured] : ratios) error += std::abs(measured.ratio - 1);
      if (error / static_cast<double>(ratios.size()) >= best_error) continue;
      best_error = error / static_cast<double>(ratios.size());
      best = factor;
    }
    return best;
  }

  /// All markers in all cameras are nearer or farther than they should be: by the print, the
  /// depth's unit or the focal length.
  void check_common_ratio(const std::vector<std::map<int, DepthRatio>>& ratios,
                          const std::map<int, std::vector<double>>& by_marker) {
    std::vector<double> all;
    for (const auto& [id, values] : by_marker) all.insert(all.end(), values.begin(), values.end());
    const double ratio = median_of(all);
    std::vector<std::size_t> cameras;
    for (std::size_t k = 0; k < ratios.size(); ++k) {
      if (!ratios[k].empty()) cameras.push_back(k);
    }
    if (ratio > unit_factor || ratio < 1 / unit_factor) {
      for (const std::size_t k : cameras) blame_unit(k, ratio);
      return;
    }
    if (cameras.size() == 1) {
      if (const auto factor = explaining_focal_length(cameras[0])) {
        Scene scaled = scene_;
        const auto world = by_marker.find(scene_.world_marker.id);
        if (world != by_marker.end()) scaled.world_marker.size_m *= median_of(world->second);
        const auto by_size = agreement(rig_, scaled);
        const auto by_focal_length =
            agreement(with_focal_length(rig_, cameras[0] + 1, *factor), scene_);
        if (by_size && by_focal_length && *by_focal_length > *by_size + least_improvement) {
          blame_focal_length(cameras[0] + 1, *factor,
                             fmt::format("so the pictures of both cameras agree by {:.2f}, with "
                                         "markers of another size by {:.2f}",
                                         *by_focal_length, *by_size));
          return;
        }
      }
    }
    for (const auto& [id, values] : by_marker) blame_marker(id, median_of(values));
  }

  /// Wrong in one camera, while other cameras say that the markers are right.
  void check_one_cameras_depth(std::size_t k, const std::map<int, DepthRatio>& ratios,
                               const std::set<int>& wrong_markers) {
    std::vector<double> wrong;
    for (const auto& [id, measured] : ratios) {
      if (wrong_markers.count(id) > 0) continue;
      if (std::abs(measured.ratio - 1) > depth_tolerance) wrong.push_back(measured.ratio);
    }
    if (wrong.empty()) return;
    const double ratio = median_of(wrong);
    if (ratio > unit_factor || ratio < 1 / unit_factor) return blame_unit(k, ratio);
    blame_focal_length(
        k + 1, ratio,
        fmt::format("its markers are {:.3f} times as far away by depth as by their size, in other "
                    "cameras they are right",
                    ratio));
  }

  /// How well the pictures agree in the kept frames if this were the set-up.
  std::optional<double> agreement(const Rig& rig, const Scene& scene) const {
    CameraPoses camera_poses(rig, scene);
    PhotometricAgreement photometric(rig);
    double sum = 0;
    std::size_t count = 0;
    for (const SetupSurvey::Kept& kept : survey_.kept) {
      if (kept.frame.color.empty()) continue;
      Poses poses;
      camera_poses.estimate(kept.frame, kept.markers, poses);
      for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
        if (!usable_[k]) continue;
        if (const auto value = photometric.of(kept.frame, poses, k)) {
          sum += *value;
          ++count;
        }
      }
    }
    if (count == 0) return std::nullopt;
    return sum / static_cast<double>(count);
  }

  /// Of the colour camera: no depth of its own says how far its markers are, but the pictures agree
  /// only with the right one.
  void check_focal_length() {
    const auto as_is = agreement(rig_, scene_);
    if (!as_is) return;
    note("photometric agreement (correlation of the cameras' pictures)", *as_is, "");
    if (explained_) return;
    double best = *as_is;
    double best_factor = 1;
    for (const double factor :
         {0.82, 0.86, 0.89, 0.91, 0.93, 0.95, 0.97, 1.03, 1.05, 1.07, 1.1, 1.13, 1.17, 1.22}) {
      const auto value = agreement(with_focal_length(rig_, 0, factor), scene_);
      if (!value || *value <= best) continue;
      best = *value;
      best_factor = factor;
    }
    if (best < least_agreement || best < *as_is + least_improvement ||
        std::abs(best_factor - 1) < focal_tolerance) {
      return;
    }
    blame_focal_length(
        0, best_factor,
        fmt::format("so the cameras' pictures agree by {:.2f}, now by {:.2f}", best, *as_is));
  }

  void check_between_cameras() {
    const bool fixed = rig_.pose_source == "fixed";
    const double most = (fixed ? 0.008 : 0.025) * rig_.color.width;
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      if (!usable_[k] || survey_.between_px[k].empty()) continue;
      const double error = median_of(survey_.between_px[k]);
      note(fmt::format("reprojection error of markers from {} to color", rig_.rgbd[k].name), error,
           "pixels");
      if (error < most || (explained_ && !fixed)) continue;
      if (fixed && check_swapped_cameras(k, most)) continue;
      explained_ = true;
      find(Severity::serious, "disagreement",
           fmt::format("{} and color do not agree where markers are", rig_.rgbd[k].name),
           fmt::format("{:.1f} pixels", error),
           fixed ? "if cameras were moved: diminish calibrate rig"
                 : "a larger world marker, seen less frontally; calibrate the cameras");
    }
  }

  /// Whether a camera with fixed poses is where another one should be.
  bool check_swapped_cameras(std::size_t k, double most_px) {
    CameraPoses camera_poses(rig_, scene_);
    const Lens color_lens(rig_.color);
    const Lens rgbd_lens(rig_.rgbd[k].color);
    for (std::size_t other = 0; other < rig_.rgbd.size(); ++other) {
      if (other == k) continue;
      std::vector<double> errors;
      for (const SetupSurvey::Kept& kept : survey_.kept) {
        Poses poses;
        camera_poses.estimate(kept.frame, kept.markers, poses);
        if (!poses.color_from_depth[other]) continue;
        const RigidTransform color_from_rgbd =
            *poses.color_from_depth[other] * rig_.rgbd[k].color_from_depth.inverse();
        const auto more = errors_between(kept.markers.color, kept.markers.rgbd[k], sizes_,
                                         color_lens, rgbd_lens, color_from_rgbd);
        errors.insert(errors.end(), more.begin(), more.end());
      }
      if (errors.empty() || median_of(errors) > most_px) continue;
      find(
          Severity::serious, "swapped",
          fmt::format("{} is where {} should be: they are swapped", rig_.rgbd[k].name,
                      rig_.rgbd[other].name),
          fmt::format("markers agree to {:.1f} pixels with the place of {}, to {:.1f} with its own",
                      median_of(errors), rig_.rgbd[other].name, median_of(survey_.between_px[k])),
          "exchange the cameras' names, in the recording or the driver");
      explained_ = true;
      return true;
    }
    return false;
  }

  void check_clocks() {
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      std::optional<ClockOffset> best;
      for (const auto& [id, way] : survey_.color_ways[k]) {
        const auto offset = estimate_clock_offset(way, survey_.rgbd_ways[k].at(id));
        if (offset && (!best || offset->deviation_s < best->deviation_s)) best = offset;
      }
      const double half_frame = survey_.frame_period_s / 2;
      if (!best || best->deviation_s > half_frame) continue;
      note(fmt::format("clock of {} after color's", rig_.rgbd[k].name), 1000 * best->offset_s,
           "milliseconds");
      if (std::abs(best->offset_s) <= std::max(half_frame, 4 * best->deviation_s)) continue;
      find(Severity::serious, "clock-offset",
           fmt::format("the clock of {} is {:.0f} ms {} color's", rig_.rgbd[k].name,
                       1000 * std::abs(best->offset_s), best->offset_s > 0 ? "ahead of" : "behind"),
           fmt::format("{:.0f} +- {:.0f} ms, by a marker's motion; half a frame is {:.0f} ms",
                       1000 * best->offset_s, 1000 * best->deviation_s, 1000 * half_frame),
           fmt::format("synchronise the clocks, or subtract {:.3f} s from its timestamps",
                       best->offset_s));
      explained_ = true;
    }
  }

  Rig rig_;      ///< with what was found corrected
  Scene scene_;  ///< the same
  SetupSurvey survey_;
  std::map<int, double> sizes_;
  std::vector<bool> usable_;  ///< RGB-D cameras whose figures mean something
  bool explained_ = false;    ///< a cause was found that moves cameras and markers
  SetupReport report_;
};

}  // namespace

SetupReport check_setup(const Rig& rig, const Scene& scene, FrameSource& source,
                        std::size_t most_frames) {
  return Checker(rig, scene, survey_setup(rig, scene, source, most_frames)).run();
}

}  // namespace diminish
