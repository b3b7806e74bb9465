#include "diminish/setup_check.h"

#include <algorithm>

#include "diminish/validate.h"
#include "setup/check/setup_checks.h"

namespace diminish {

SetupReport check_setup(const Rig& rig, const Scene& scene, FrameSource& source,
                        std::size_t most_frames) {
  validate(rig);
  validate(scene, rig);
  Diagnosis setup(rig, scene, survey_setup(rig, scene, source, most_frames));
  check_streams(setup);
  check_exposure(setup);
  check_markers(setup);
  check_depth(setup);
  // Fixed poses are either right or explain what follows; those from markers depend on all else.
  const bool fixed = rig.pose_source == "fixed";
  if (fixed) check_between_cameras(setup);
  check_focal_length(setup);
  check_clocks(setup);
  if (!fixed) check_between_cameras(setup);
  check_pose_bias(setup);
  std::vector<Finding>& findings = setup.report.findings;
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return std::move(setup.report);
}

}  // namespace diminish
