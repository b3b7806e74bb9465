#include "setup/check/diagnosis.h"

#include <algorithm>
#include <utility>

#include "core/robust.h"
#include "pose/known_markers.h"

namespace diminish {

Diagnosis::Diagnosis(const Rig& rig_, const Scene& scene_, SetupSurvey survey_)
    : rig(rig_), scene(scene_), survey(std::move(survey_)), sizes(known_marker_sizes(scene)) {
  report.frames = survey.frames;
  usable.assign(rig.rgbd.size(), true);
}

void Diagnosis::find(Finding::Severity severity, std::string code, std::string what,
                     std::string figure, std::string remedy) {
  report.findings.push_back(
      {severity, std::move(code), std::move(what), std::move(figure), std::move(remedy)});
}

void Diagnosis::note(std::string name, double value, std::string unit) {
  report.figures.push_back({std::move(name), value, std::move(unit)});
}

std::vector<const SensorSurvey*> Diagnosis::sensors() const {
  std::vector<const SensorSurvey*> all = {&survey.color};
  for (const SensorSurvey& sensor : survey.rgbd) all.push_back(&sensor);
  return all;
}

void Diagnosis::mark_unusable(std::size_t sensor) {
  if (sensor == 0) {
    std::fill(usable.begin(), usable.end(), false);
  } else {
    usable[sensor - 1] = false;
  }
}

double median_of(std::vector<double> values) {
  return values.empty() ? 0 : median(values);
}

}  // namespace diminish
