#include "composite/shadow_gain.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "composite/scale_light.h"
#include "core/bilinear.h"
#include "core/robust.h"
#include "core/runs.h"
#include "diminish/diminished_frame.h"
#include "geometry/symmetric_solver.h"
#include "scene/background_planes.h"
#include "scene/shadow_fit.h"

namespace diminish {
namespace {

using Levels = Eigen::Array4f;

/// With more light than this a cell is lit.
constexpr float lit = 0.98F;
/// Light is not lowered below this.
constexpr float least_light = ShadowFit::least_light;
/// Of whole parts of cells in a shadow, and of cells that show the field.
constexpr int fewest_shaded = 32;
constexpr std::size_t fewest_cells = 24;
/// Rows of cells.
constexpr int cell_rows_together = 8;
/// Of a cell that counts.
constexpr float least_weight = 0.05F;
/// Colours are 0 to 1.
constexpr float least_field = 0.03F;
/// Of the brightness beside the field; more is a highlight or another thing.
constexpr float most_bright = 1.3F;
/// The field and the gains need one another; so many times they are found in turn.
constexpr int passes = 3;
constexpr int robust_passes = 3;
/// How many times the texture's variance the prior weighs.
constexpr float prior_by_texture = 2;
/// A shadow changes its colour less than its depth: how many times the prior weighs for a channel's
/// gain beside the brightness's.
constexpr float prior_of_channels = 4;
constexpr float least_texture = 0.02F;
constexpr float least_gain = 0.1F;
constexpr auto most_dark = static_cast<std::uint8_t>(255 * (1 - least_light));

/// The mean colour of a part of a cell and its brightness, 0 to 1.
Levels mean_of_part(const Image<Bgr>& image, int left, int top, int size) {
  int b = 0;
  int g = 0;
  int r = 0;
  for (int y = top; y < top + size; ++y) {
    const Bgr* const row = image.row(y) + left;
    for (int x = 0; x < size; ++x) {
      b += row[x].b;
      g += row[x].g;
      r += row[x].r;
    }
  }
  return Eigen::Array4i(3 * b, 3 * g, 3 * r, b + g + r).cast<float>() /
         static_cast<float>(3 * 255 * size * size);
}

/// Means of two by two cells. Beyond the border is 0.
template <class Value>
void halve(const Image<Value>& fine, Image<Value>& coarse) {
  for (int row = 0; row < coarse.height(); ++row) {
    const Value* const above = fine.row(2 * row);
    const bool has_below = 2 * row + 1 < fine.height();
    const Value* const below = fine.row(has_below ? 2 * row + 1 : 2 * row);
    for (int column = 0; column < coarse.width(); ++column) {
      const int left = 2 * column;
      const bool has_right = left + 1 < fine.width();
      Value sum = above[left];
      if (has_right) sum += above[left + 1];
      if (has_below) sum += below[left];
      if (has_right && has_below) sum += below[left + 1];
      coarse(column, row) = sum / 4;
    }
  }
}

/// A place, counted in pixels `step` times as fine as cells, between cells' centres.
float in_cells(int place, int step, int cells) {
  return std::clamp((static_cast<float>(place) + 0.5F) / static_cast<float>(step) - 0.5F, 0.F,
                    static_cast<float>(cells - 1));
}

}  // namespace

void ShadowGain::Scale::resize(int width, int height) {
  weight.resize(width, height, 0);
  color.resize(width, height, Levels::Zero());
  dark.resize(width, height, Levels::Zero());
  agreement.resize(width, height);
  square.resize(width, height);
  gain.resize(width, height, Levels::Ones());
}

void ShadowGain::apply(const Inputs& inputs, Surfaces& surfaces) {
  constexpr int smallest = cell_px << (scales - 1);
  if (surfaces.region.width < smallest || surfaces.region.height < smallest) return;
  for (const CastShadow& shadow : inputs.shadows) {
    if (!gather(inputs, surfaces, shadow.label)) continue;
    gather_samples(inputs, shadow, surfaces.region);
    bool is_found = true;
    for (int pass = 0; pass < passes && is_found; ++pass) {
      is_found = fit_field(pass == 0);
      if (is_found) find_gains(pass + 1 < passes ? field_scale : 0);
    }
    if (is_found) scale_light(shadow.label, surfaces);
  }
}

/// Fills weight, colour and dark at the finest scale, from parts of cells that are all camera or
/// all seen. Returns whether the plane has a shadow.
bool ShadowGain::gather(const Inputs& inputs, const Surfaces& surfaces, std::uint8_t label) {
  const Rect& region = surfaces.region;
  Scale& fine = scales_.front();
  fine.resize(region.width / cell_px, region.height / cell_px);
  constexpr int in_row = cell_px / part_px;
  constexpr float parts = in_row * in_row;
  const auto add = [&](int left, int top, int column, int row) {
    const std::uint8_t origin = inputs.provenance(left, top);
    if (origin >= provenance::witnessed) return false;
    for (int y = top; y < top + part_px; ++y) {
      if (!all_equal<part_px>(surfaces.label.row(y) + left, label)) return false;
      if (!all_equal<part_px>(inputs.provenance.row(y) + left, origin)) return false;
    }
    const float weight = (origin == provenance::camera ? 1 : seen_weight) / parts;
    const Levels color = mean_of_part(inputs.picture, left, top, part_px);
    const Levels dark = 1 - mean_of_part(surfaces.light, left, top, part_px);
    fine.weight(column, row) += weight;
    fine.color(column, row) += weight * color;
    fine.dark(column, row) += weight * dark;
    return dark[brightness] > 1 - lit;
  };
  std::atomic<int> shaded = 0;
  for_row_groups(fine.weight.height(), cell_rows_together, [&](Rows rows) {
    int count = 0;
    for (int row = rows.first; row < rows.last; ++row) {
      for (int y = 0; y < cell_px; y += part_px) {
        for (int x = 0; x < fine.weight.width() * cell_px; x += part_px) {
          count += add(region.x + x, region.y + row * cell_px + y, x / cell_px, row) ? 1 : 0;
        }
      }
    }
    shaded += count;
  });
  if (shaded < fewest_shaded) return false;
  for (std::size_t i = 1; i < scales; ++i) {
    scales_[i].resize((scales_[i - 1].weight.width() + 1) / 2,
                      (scales_[i - 1].weight.height() + 1) / 2);
    halve(scales_[i - 1].weight, scales_[i].weight);
    halve(scales_[i - 1].color, scales_[i].color);
    halve(scales_[i - 1].dark, scales_[i].dark);
  }
  return true;
}

/// Of the plane around the region, where nothing hides light from it.
void ShadowGain::gather_samples(const Inputs& inputs, const CastShadow& shadow,
                                const Rect& region) {
  cells_.clear();
  const Rect whole = inputs.picture.bounds();
  for (const SceneSample& sample : inputs.samples) {
    if (!BackgroundPlanes::lies_on(shadow.ground.plane, sample.point_m)) continue;
    const Rect part{static_cast<int>(sample.pixel.x()) - part_px / 2,
                    static_cast<int>(sample.pixel.y()) - part_px / 2, part_px, part_px};
    if (intersect(part, whole) != part || shadow.light_at(sample.point_m) < lit) continue;
    bool is_camera = true;
    for (int y = part.y; y < part.bottom(); ++y) {
      is_camera &= all_equal<part_px>(inputs.provenance.row(y) + part.x, provenance::camera);
    }
    if (!is_camera) continue;
    const Eigen::Vector2f place = (sample.pixel - Eigen::Vector2f(region.x, region.y)) / cell_px;
    cells_.push_back({monomials(place.x(), place.y()),
                      mean_of_part(inputs.picture, part.x, part.y, part_px), 1, 1});
  }
  sample_count_ = cells_.size();
}

/// x, y: in cells of the finest scale.
ShadowGain::Terms ShadowGain::monomials(float x, float y) const {
  const Scale& fine = scales_.front();
  const auto size = static_cast<float>(std::max(fine.weight.width(), fine.weight.height()));
  x /= size;
  y /= size;
  return Terms{{1, x, y, x * x, x * y, y * y}};
}
ShadowGain::Terms ShadowGain::monomials(std::size_t scale, int column, int row) const {
  const auto cells = static_cast<float>(1 << scale);
  return monomials(cells * (static_cast<float>(column) + 0.5F),
                   cells * (static_cast<float>(row) + 0.5F));
}

/// Robust least squares over the cells of one scale: at first those without a shadow, which also
/// give the hue, then all, without the shadow that is known by then. Also measures the texture.
bool ShadowGain::fit_field(bool only_lit) {
  const Scale& scale = scales_[field_scale];
  cells_.resize(sample_count_);
  for (int row = 0; row < scale.weight.height(); ++row) {
    for (int column = 0; column < scale.weight.width(); ++column) {
      const float weight = scale.weight(column, row);
      if (weight < least_weight) continue;
      const Levels dark = scale.dark(column, row) / weight;
      if (only_lit && dark[brightness] > 1 - lit) continue;
      const Levels light = (1 - scale.gain(column, row) * dark).max(least_light);
      cells_.push_back({monomials(field_scale, column, row),
                        scale.color(column, row) / weight / light, weight, 1});
    }
  }
  if (cells_.size() < fewest_cells) return false;
  if (only_lit) {
    Levels sum = Levels::Zero();
    for (const Cell& cell : cells_) sum += cell.weight * cell.color;
    hue_ = sum / std::max(sum[brightness], least_field);
  }
  for (int pass = 0; pass < robust_passes; ++pass) {
    Eigen::Matrix<float, terms, terms> squares = 1e-4F * Terms::Ones().asDiagonal().toDenseMatrix();
    Terms products = Terms::Zero();
    for (const Cell& cell : cells_) {
      const Terms weighted = cell.weight * cell.trust * cell.monomials;
      squares += weighted * cell.monomials.transpose();
      products += cell.color[brightness] * weighted;
    }
    field_ = solve_symmetric(squares, products);
    residuals_.clear();
    for (const Cell& cell : cells_) residuals_.push_back(residual(cell));
    texture_ = std::max(least_texture, 1.48F * median(residuals_));
    for (Cell& cell : cells_) cell.trust = tukey_weight(residual(cell), 4.7F * texture_);
  }
  return true;
}

/// The brightness of the plane without a shadow.
float ShadowGain::field_at(const Terms& monomials) const {
  return std::max(field_.dot(monomials), least_field);
}

/// Of the brightness, relative to the field.
float ShadowGain::residual(const Cell& cell) const {
  return std::abs(cell.color[brightness] / field_at(cell.monomials) - 1);
}

/// The brightness's gain, and those of the channels: the coarser scale says how they differ.
ShadowGain::Levels ShadowGain::gain_of(const Levels& agreement, const Levels& square,
                                       const Levels& coarse, float prior) {
  const float common = std::clamp(
      (agreement[brightness] + prior * coarse[brightness]) / (square[brightness] + prior), 0.F,
      most);
  const Levels expected = coarse * (common / std::max(coarse[brightness], least_gain));
  const float weight = prior_of_channels * prior;
  Levels gain = ((agreement + weight * expected) / (square + weight)).max(0.F).min(most);
  gain[brightness] = common;
  return gain;
}

/// From the coarsest scale to `finest`.
void ShadowGain::find_gains(std::size_t finest) {
  Scale& from = scales_[finest];
  for (int row = 0; row < from.weight.height(); ++row) {
    for (int column = 0; column < from.weight.width(); ++column) {
      const float weight = from.weight(column, row);
      Levels& agreement = from.agreement(column, row);
      Levels& square = from.square(column, row);
      if (weight < least_weight) {
        agreement.setZero();
        square.setZero();
        continue;
      }
      const Levels field = hue_ * field_at(monomials(finest, column, row));
      const Levels missing = 1 - (from.color(column, row) / weight / field).min(most_bright);
      const Levels dark = from.dark(column, row);
      agreement = dark * missing;
      square = dark * dark / weight;
    }
  }
  for (std::size_t i = finest + 1; i < scales; ++i) {
    halve(scales_[i - 1].agreement, scales_[i].agreement);
    halve(scales_[i - 1].square, scales_[i].square);
  }
  const float prior = prior_by_texture * texture_ * texture_;
  for (std::size_t i = scales; i-- > finest;) {
    Scale& scale = scales_[i];
    // Nearly Gaussians of two cells; of one at the finest scale.
    for (Image<Levels>* const image : {&scale.agreement, &scale.square}) {
      i == 0 ? blur<1>(*image) : blur<2>(*image);
    }
    for (int row = 0; row < scale.weight.height(); ++row) {
      for (int column = 0; column < scale.weight.width(); ++column) {
        const Levels coarse =
            i + 1 < scales ? coarser_gain(i, column, row) : Levels(Levels::Ones());
        scale.gain(column, row) =
            gain_of(scale.agreement(column, row), scale.square(column, row), coarse, prior);
      }
    }
  }
}

/// Between the four nearest cells of the next coarser scale.
ShadowGain::Levels ShadowGain::coarser_gain(std::size_t scale, int column, int row) const {
  const Image<Levels>& gain = scales_[scale + 1].gain;
  const int last_column = gain.width() - 1;
  const int last_row = gain.height() - 1;
  return bilinear(in_cells(column, 2, gain.width()), in_cells(row, 2, gain.height()),
                  [&](int x, int y) -> Levels {
                    return gain(std::min(x, last_column), std::min(y, last_row));
                  });
}

/// Two means along rows, then along columns. Beyond the border is 0.
template <int reach>
void ShadowGain::blur(Image<Levels>& image) {
  constexpr int count = 2 * reach + 1;
  const int width = image.width();
  const int height = image.height();
  // A frame of zeros around the image.
  padded_.resize(width + 2 * reach, height + 2 * reach, Levels::Zero());
  const auto mean = [&](const Levels* first, std::ptrdiff_t step) -> Levels {
    Levels sum = *first;
    for (int i = 1; i < count; ++i) sum += first[i * step];
    return sum / static_cast<float>(count);
  };
  for (const bool along_rows : {true, true, false, false}) {
    for (int row = 0; row < height; ++row) {
      std::copy_n(image.row(row), width, padded_.row(row + reach) + reach);
    }
    for (int row = 0; row < height; ++row) {
      const Levels* const first = along_rows ? padded_.row(row + reach) : padded_.row(row) + reach;
      for (int column = 0; column < width; ++column) {
        image(column, row) = mean(first + column, along_rows ? 1 : padded_.width());
      }
    }
  }
}

void ShadowGain::scale_light(std::uint8_t label, Surfaces& surfaces) {
  static_assert(cell_px == LightGains::cell_px);
  static_assert(static_cast<int>(most * LightGains::one) * 255 < 1 << 16);
  const Rect& region = surfaces.region;
  const Image<Levels>& gain = scales_.front().gain;
  for_rows(region.height, [&](Rows rows) {
    std::vector<Eigen::Array4i>& by_cell = by_cell_[rows.band];
    by_cell.resize(static_cast<std::size_t>(gain.width()));
    for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
      Bgr* const light = surfaces.light.row(y) + region.x;
      const int count = 3 * region.width;
      if (find_other(reinterpret_cast<const std::uint8_t*>(light), 0, count, 255) == count)
        continue;
      const float at = in_cells(y - region.y, cell_px, gain.height());
      const int row = static_cast<int>(at);
      const float share = at - static_cast<float>(row);
      const Levels* const above = gain.row(row);
      const Levels* const below = gain.row(std::min(row + 1, gain.height() - 1));
      for (int i = 0; i < gain.width(); ++i) {
        const Levels here = above[i] + share * (below[i] - above[i]);
        by_cell[static_cast<std::size_t>(i)] = (here * LightGains::one).cast<int>();
      }
      diminish::scale_light({by_cell, label, most_dark}, surfaces.label.row(y) + region.x,
                            region.width, light);
    }
  });
}

}  // namespace diminish
