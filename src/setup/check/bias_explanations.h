#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diminish/rig.h"
#include "setup/check/diagnosis.h"

namespace diminish {

/// Something that would move the colour camera the same way in every frame, and how well the
/// cameras' pictures agree if it is corrected.
struct BiasExplanation {
  enum class Kind { pose, principal_point, focal_length, distortion };

  Kind kind = Kind::pose;
  std::string corrected;  ///< "a focal length of 1131 pixels"
  /// One for each kept frame and RGB-D camera (PhotometricAgreement).
  std::vector<std::optional<double>> agreements;

  bool is_lens() const { return kind != Kind::pose; }
};

/// The mean of those that are there; 0 if there are none.
double mean_agreement(const std::vector<std::optional<double>>& agreements);

/// How well the pictures agree as they are. Paired with BiasExplanation::agreements.
std::vector<std::optional<double>> agreements_as_is(const Diagnosis& setup);

/// All of them, the best first. refinement: of the colour camera's pose, in its own frame. Each of
/// the lens's numbers is looked for uphill. Cost: some 60 times all kept frames' agreement,
/// seconds.
std::vector<BiasExplanation> explain_bias(const Diagnosis& setup, const RigidTransform& refinement);

/// Whether the pictures tell that `a` is better than `b`: by more than the difference's noise.
bool is_better(const BiasExplanation& a, const BiasExplanation& b);

}  // namespace diminish
