#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "diminish/export.h"
#include "diminish/frame_source.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// Something wrong with a set-up.
struct Finding {
  enum class Severity { warning, serious };

  Severity severity = Severity::warning;
  std::string code;    ///< one word, for programs: "marker-size"
  std::string what;    ///< in plain words
  std::string figure;  ///< what was measured, with its unit
  std::string remedy;  ///< what to do
};

/// A measured figure, right or wrong.
struct SetupFigure {
  std::string name;
  double value = 0;
  std::string unit;
};

struct SetupReport {
  std::size_t frames = 0;
  std::vector<Finding> findings;
  std::vector<SetupFigure> figures;

  bool fine() const { return findings.empty(); }
};

/// Checks a set-up's frames and says what is wrong with its configuration. Of several causes that
/// would explain the same figures, names the one that makes the cameras' pictures agree best. Once
/// a cause is found, its consequences are not reported again. Keeps six frames in memory. Throws
/// Error on configurations that cannot be read at all. Cost: the first stages of the pipeline, plus
/// some seconds.
DIMINISH_EXPORT SetupReport check_setup(const Rig& rig, const Scene& scene, FrameSource& source,
                                        std::size_t most_frames = 300);

/// For people.
DIMINISH_EXPORT std::string setup_report_text(const SetupReport& report);
/// For programs: {"frames", "findings": [...], "figures": [...]}.
DIMINISH_EXPORT std::string setup_report_json(const SetupReport& report);

}  // namespace diminish
