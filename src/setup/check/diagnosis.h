#pragma once

#include <map>
#include <string>
#include <vector>

#include "diminish/rig.h"
#include "diminish/scene.h"
#include "diminish/setup_check.h"
#include "setup/check/setup_survey.h"

namespace diminish {

/// What was seen of a set-up, and what has been found wrong with it.
struct Diagnosis {
  Diagnosis(const Rig& rig, const Scene& scene, SetupSurvey survey);

  Rig rig;      ///< with the findings corrected
  Scene scene;  ///< the same
  SetupSurvey survey;
  std::map<int, double> sizes;  ///< the scene's markers by id, metres; also corrected
  std::vector<bool> usable;     ///< RGB-D cameras with meaningful figures
  bool explained = false;       ///< a cause was found that shifts cameras and markers
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
inline ImageView<Bgr> image_of(const SetupSurvey::Kept& kept, std::size_t sensor) {
  return sensor == 0 ? kept.frame.color : kept.frame.rgbd[sensor - 1].color;
}

/// 0 if there are none.
double median_of(std::vector<double> values);

}  // namespace diminish
