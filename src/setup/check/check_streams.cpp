#include "setup/check/setup_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "setup/check/clock_offset.h"

namespace diminish {
namespace {

using Severity = Finding::Severity;

constexpr double dark_level = 35;
constexpr double overexposed_share = 0.2;

}  // namespace

void check_streams(Diagnosis& setup) {
  for (std::size_t k = 0; k < setup.rig.rgbd.size(); ++k) {
    const std::string& name = setup.rig.rgbd[k].name;
    const std::size_t missing = setup.survey.missing[k];
    setup.note(name + ": frames with its images",
               static_cast<double>(setup.survey.frames - missing), "");
    if (10 * missing <= setup.survey.frames) continue;
    const bool none = 2 * missing > setup.survey.frames;
    if (missing == setup.survey.frames) setup.usable[k] = false;
    setup.find(
        none ? Severity::serious : Severity::warning, "no-partner",
        fmt::format("{} of {} frames have no images of {}", missing, setup.survey.frames, name),
        setup.survey.first_missing[k],
        "synchronise the clocks, or shift the timestamps in its lists; if they are only slightly "
        "off, raise --sync-tolerance-s");
  }
  if (setup.survey.fault_count > 0) {
    setup.find(Severity::warning, "faults",
               fmt::format("{} images could not be used", setup.survey.fault_count),
               setup.survey.faults.front(), "record again, or find out what damages the files");
  }
}

void check_exposure(Diagnosis& setup) {
  for (const SensorSurvey* sensor : setup.sensors()) {
    if (sensor->images == 0) continue;
    const double level = median_of(sensor->brightness);
    const double over = median_of(sensor->overexposed);
    setup.note(sensor->name + ": brightness", level, "levels");
    if (level < dark_level) {
      setup.find(Severity::warning, "dark", sensor->name + " is too dark",
                 fmt::format("mean brightness {:.0f} of 255", level),
                 "use more light, a longer exposure or a larger aperture");
    }
    if (over > overexposed_share) {
      setup.find(Severity::warning, "overexposed", sensor->name + " is overexposed",
                 fmt::format("{:.0f} % of its pixels are white", 100 * over),
                 "use a shorter exposure or less light");
    }
  }
}

void check_clocks(Diagnosis& setup) {
  for (std::size_t k = 0; k < setup.rig.rgbd.size(); ++k) {
    std::optional<ClockOffset> best;
    for (const auto& [id, way] : setup.survey.color_ways[k]) {
      const auto offset = estimate_clock_offset(way, setup.survey.rgbd_ways[k].at(id));
      if (offset && (!best || offset->deviation_s < best->deviation_s)) best = offset;
    }
    const double half_frame = setup.survey.frame_period_s / 2;
    if (!best || best->deviation_s > half_frame) continue;
    setup.note(fmt::format("clock of {} minus color's", setup.rig.rgbd[k].name),
               1000 * best->offset_s, "milliseconds");
    if (std::abs(best->offset_s) <= std::max(half_frame, 4 * best->deviation_s)) continue;
    setup.find(
        Severity::serious, "clock-offset",
        fmt::format("the clock of {} is {:.0f} ms {} color's", setup.rig.rgbd[k].name,
                    1000 * std::abs(best->offset_s), best->offset_s > 0 ? "ahead of" : "behind"),
        fmt::format("{:.0f} +- {:.0f} ms, by a marker's motion; half a frame is {:.0f} ms",
                    1000 * best->offset_s, 1000 * best->deviation_s, 1000 * half_frame),
        fmt::format("synchronise the clocks, or subtract {:.3f} s from its timestamps",
                    best->offset_s));
    setup.explained = true;
  }
}

}  // namespace diminish
