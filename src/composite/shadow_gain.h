#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/rows.h"
#include "diminish/image.h"
#include "diminish/scene_samples.h"
#include "diminish/surfaces.h"
#include "scene/cast_shadows.h"

namespace diminish {

/// Brings the objects' shadows (Surfaces::light) to what the picture shows of them.
///
/// The light was found from few samples and few directions: its shadows are blurred, and too faint
/// where they should be deep. Each plane's colour in the picture is taken for a smooth field times
/// the light,
///
///   Y(p) = F(p) (1 - g(p) (1 - light(p))),
///
/// F a quadratic of the pixel times the plane's hue, and g a gain that changes slowly where little
/// is seen of a shadow, and within a few pixels where it is deep. g is found from coarse to fine:
/// at each scale it is the weighted least-squares gain of the neighbourhood, with the next coarser
/// scale's as its prior. The prior weighs as much as the plane's texture, measured in the frame,
/// can mislead. The gains of the channels are held to that of the brightness. A shadow that the
/// picture does not show gets a gain of 0.
class ShadowGain {
 public:
  /// Pixels of a cell, in which colours are averaged.
  static constexpr int cell_px = 8;
  /// The largest gain.
  static constexpr float most = 2.5F;
  /// What an RGB-D camera saw counts less than what the user's camera sees itself.
  static constexpr float seen_weight = 0.3F;

  /// picture: the camera's outside the mask, with corrected colours where something was seen (by
  /// provenance), the shadows still in it. samples: in the colour camera's frame; they show the
  /// planes beyond the region.
  struct Inputs {
    const Image<Bgr>& picture;
    const Image<std::uint8_t>& provenance;
    std::span<const CastShadow> shadows;
    const std::vector<SceneSample>& samples;
  };
  /// Changes `surfaces.light` in its region. Cost: 14 million instructions for the calendar (500 by
  /// 400 pixels, half of them shaded).
  void apply(const Inputs& inputs, Surfaces& surfaces);

 private:
  /// From fine to coarse: cells of 8, 16, 32 pixels.
  static constexpr std::size_t scales = 3;
  /// Fields are fitted at this scale.
  static constexpr std::size_t field_scale = 1;
  /// What is averaged together belongs to one plane and origin.
  static constexpr int part_px = 4;
  static constexpr int terms = 6;
  using Terms = Eigen::Matrix<float, terms, 1>;
  /// By channel: blue, green, red and the brightness, which is their mean.
  using Levels = Eigen::Array4f;
  static constexpr int brightness = 3;

  /// Means over cells, from 0 to 1. All but the gain are products with the weight.
  struct Scale {
    Image<float> weight;
    Image<Levels> color;
    Image<Levels> dark;       ///< 1 - light
    Image<Levels> agreement;  ///< (1 - light) (1 - Y / F)
    Image<Levels> square;     ///< (1 - light)^2
    Image<Levels> gain;

    void resize(int width, int height);
  };
  struct Cell {
    Terms monomials;
    Levels color;
    float weight, trust;
  };

  bool gather(const Inputs& inputs, const Surfaces& surfaces, std::uint8_t label);
  void gather_samples(const Inputs& inputs, const CastShadow& shadow, const Rect& region);
  Terms monomials(float x, float y) const;
  Terms monomials(std::size_t scale, int column, int row) const;
  bool fit_field(bool only_lit);
  float field_at(const Terms& monomials) const;
  float residual(const Cell& cell) const;
  void find_gains(std::size_t finest);
  static Levels gain_of(const Levels& agreement, const Levels& square, const Levels& coarse,
                        float prior);
  template <int reach>
  void blur(Image<Levels>& image);
  Levels coarser_gain(std::size_t scale, int column, int row) const;
  void scale_light(std::uint8_t label, Surfaces& surfaces);

  std::array<Scale, scales> scales_;
  std::vector<Cell> cells_;
  std::size_t sample_count_ = 0;  ///< the first cells are samples without a shadow
  Terms field_;
  Levels hue_;         ///< of the plane, relative to its brightness
  float texture_ = 0;  ///< relative to the field, one standard deviation
  std::vector<float> residuals_;
  Image<Levels> padded_;
  std::vector<Eigen::Array4i> by_cell_[most_bands];  ///< gains of a row, of each band
};

}  // namespace diminish
