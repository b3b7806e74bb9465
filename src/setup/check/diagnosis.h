#pragma once

#include <map>
#include <string>
#include <vector>

#include "diminish/rig.h"
#include "diminish/scene.h"
#include "diminish/setup_check.h"
#include "setup/check/setup_survey.h"

namespace diminish {

/// What was seen of a set-up, and what was found wrong with it so far.
struct Diagnosis {
  Diagnosis(const Rig& rig, const Scene& scene, SetupSurvey survey);

  Rig rig;      ///< with what was found corrected
  Scene scene;  ///< the same
  SetupSurvey survey;
  std::map<int, double> sizes;  ///< of the scene's markers, metres, by id; corrected, too
  std::vector<bool> usable;     ///< RGB-D cameras whose figures mean something
  bool explained = false;       ///< a cause was found that moves cameras and markers
  SetupReport report;

  void find(Finding::Severity severity, std::string code, std::string what, std::string figure,
            std::string remedy);
  void note(std::string name, double value, std::string unit);

  // Colour sensors by number: 0 is the colour camera, k + 1 RGB-D camera k's.

  std::vector<const SensorSurvey*> sensors() const;
  void mark_unusable(std::size_t sensor);
};

inline Intrinsics& color_sensor(Rig& rig, std::size_t sensor) {
  return sensor == 0 ? rig.color : rig.rgbd[sensor - 1].color;
}
inline const Intrinsics& color_sensor(const Rig& rig, std::size_t sensor) {
  return sensor == 0 ? rig.color : rig.rgbd[sensor - 1].color;
}
inline const Image<Bgr>& image_of(const SetupSurvey::Kept& kept, std::size_t sensor) {
  return sensor == 0 ? kept.frame.color : kept.frame.rgbd[sensor - 1].color;
}

/// 0 if there are none.
double median_of(std::vector<double> values);

}  // namespace diminish
