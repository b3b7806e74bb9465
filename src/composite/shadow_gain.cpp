#include "composite/shadow_gain.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/robust.h"
#include "core/rows.h"
#include "core/runs.h"
#include "diminish/diminished_frame.h"
#include "scene/background_planes.h"
#include "scene/shadow_fit.h"

namespace diminish {
namespace {

/// With more light than this a cell is lit.
constexpr float lit = 0.98F;
/// Light is not lowered below this.
constexpr float least_light = ShadowFit::least_light;
/// A gain in fixed point: the largest one, times the largest level, fits 16 bits.
constexpr std::uint8_t one = 64;
constexpr auto most_dark = static_cast<std::uint16_t>(255 * (1 - least_light));
/// Cells in a shadow, at the finest scale, and cells that show the field.
constexpr int fewest_shaded = 32;
constexpr std::size_t fewest_cells = 24;
/// Of a cell that counts.
constexpr float least_weight = 0.05F;
/// Brightness is 0 to 1.
constexpr float least_field = 0.03F;
/// Of the brightness beside the field; more is a highlight or another thing.
constexpr float most_bright = 1.3F;
/// The field and the gains need one another; so many times they are found in turn.
constexpr int passes = 3;
constexpr int robust_passes = 3;
/// How many times the texture's variance the prior weighs.
constexpr float prior_by_texture = 2;
constexpr float least_texture = 0.02F;
/// The sum of a white cell's channels.
constexpr float full = 3 * 255 * ShadowGain::cell_px * ShadowGain::cell_px;

int sum_of(const Bgr& color) {
  return color.b + color.g + color.r;
}

/// Whether a row of a cell has one value.
bool is_even(const std::uint8_t* bytes, std::uint8_t value) {
  std::uint32_t word = 0;
  static_assert(sizeof word == ShadowGain::cell_px);
  std::memcpy(&word, bytes, sizeof word);
  return word == 0x01010101U * value;
}

/// Means of two by two cells. Beyond the border is 0.
void halve(const Image<float>& fine, Image<float>& coarse) {
  for (int row = 0; row < coarse.height(); ++row) {
    const float* const above = fine.row(2 * row);
    const bool has_below = 2 * row + 1 < fine.height();
    const float* const below = fine.row(has_below ? 2 * row + 1 : 2 * row);
    for (int column = 0; column < coarse.width(); ++column) {
      const int left = 2 * column;
      const int right = std::min(left + 1, fine.width() - 1);
      const float share = right > left ? 1 : 0;
      const float upper = above[left] + share * above[right];
      const float lower = below[left] + share * below[right];
      coarse(column, row) = (upper + (has_below ? lower : 0)) / 4;
    }
  }
}

/// The cells beside a place, and how near it is to the second.
struct Between {
  int first, second;
  float share;
};
/// place: counted in pixels `step` times as fine as the cells.
Between between(int place, int step, int cells) {
  const float at = std::clamp((static_cast<float>(place) + 0.5F) / static_cast<float>(step) - 0.5F,
                              0.F, static_cast<float>(cells - 1));
  const int first = static_cast<int>(at);
  return {first, std::min(first + 1, cells - 1), at - static_cast<float>(first)};
}

/// From gains at the centres of cells to those of a row of channels; 1 where the label is another.
void spread(const std::vector<int>& by_cell, const std::uint8_t* labels, std::uint8_t label,
            int width, std::uint8_t* by_channel) {
  static_assert(ShadowGain::cell_px == 4);
  const int* const cells = by_cell.data();
  const auto count = static_cast<int>(by_cell.size());
  for (int x = 0; x < width; ++x) {
    // Eighths of a cell from the first one's centre.
    const int at = std::max(2 * x - 3, 0);
    const int left = std::min(at >> 3, count - 1);
    const int right = std::min(left + 1, count - 1);
    const int by = (8 * cells[left] + (at & 7) * (cells[right] - cells[left])) >> 3;
    const auto here = static_cast<std::uint8_t>(labels[x] == label ? by : one);
    for (int c = 0; c < 3; ++c) by_channel[3 * x + c] = here;
  }
}

/// Multiplies what is lost of the light. Without a branch, so that the compiler vectorises it.
void scale_row(const std::uint8_t* __restrict__ by, int count, std::uint8_t* __restrict__ levels) {
  for (int i = 0; i < count; ++i) {
    const auto lost = static_cast<std::uint16_t>(255 - levels[i]);
    const auto scaled =
        static_cast<std::uint16_t>(static_cast<std::uint16_t>(by[i] * lost + one / 2) / one);
    levels[i] = static_cast<std::uint8_t>(255 - std::min(scaled, most_dark));
  }
}

}  // namespace

void ShadowGain::Scale::resize(int width, int height) {
  for (auto* image : {&weight, &brightness, &dark, &agreement, &square})
    image->resize(width, height);
  gain.resize(width, height, 1);
}

void ShadowGain::apply(const Inputs& inputs, Surfaces& surfaces) {
  constexpr int smallest = cell_px << (scales - 1);
  if (surfaces.region.width < smallest || surfaces.region.height < smallest) return;
  for (const CastShadows::Shadow& shadow : inputs.shadows) {
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

/// Fills weight, brightness and dark at the finest scale, from cells that are all camera or all
/// seen. Returns whether the plane has a shadow.
bool ShadowGain::gather(const Inputs& inputs, const Surfaces& surfaces, std::uint8_t label) {
  const Rect& region = surfaces.region;
  Scale& fine = scales_.front();
  fine.resize(region.width / cell_px, region.height / cell_px);
  const auto darken = [&](int column, int row) {
    const int left = region.x + column * cell_px;
    const int top = region.y + row * cell_px;
    const std::uint8_t origin = inputs.provenance(left, top);
    bool is_pure = origin < provenance::witnessed;
    int level = 0;
    int light = 0;
    for (int y = top; is_pure && y < top + cell_px; ++y) {
      is_pure = is_even(surfaces.label.row(y) + left, label) &&
                is_even(inputs.provenance.row(y) + left, origin);
      for (int x = left; x < left + cell_px; ++x) {
        level += sum_of(inputs.picture(x, y));
        light += sum_of(surfaces.light(x, y));
      }
    }
    const float weight = !is_pure ? 0 : origin == provenance::camera ? 1 : seen_weight;
    const float dark = 1 - static_cast<float>(light) / full;
    fine.weight(column, row) = weight;
    fine.brightness(column, row) = weight * static_cast<float>(level) / full;
    fine.dark(column, row) = weight * dark;
    return is_pure && dark > 1 - lit;
  };
  const int shaded = sum_over_rows(fine.weight.height(), [&](Rows rows) {
    int count = 0;
    for (int row = rows.first; row < rows.last; ++row) {
      for (int column = 0; column < fine.weight.width(); ++column) {
        count += darken(column, row) ? 1 : 0;
      }
    }
    return count;
  });
  if (shaded < fewest_shaded) return false;
  for (std::size_t i = 1; i < scales; ++i) {
    scales_[i].resize((scales_[i - 1].weight.width() + 1) / 2,
                      (scales_[i - 1].weight.height() + 1) / 2);
    halve(scales_[i - 1].weight, scales_[i].weight);
    halve(scales_[i - 1].brightness, scales_[i].brightness);
    halve(scales_[i - 1].dark, scales_[i].dark);
  }
  return true;
}

/// Of the plane around the region, where nothing hides light from it.
void ShadowGain::gather_samples(const Inputs& inputs, const CastShadows::Shadow& shadow,
                                const Rect& region) {
  cells_.clear();
  const Rect whole = inputs.picture.bounds();
  for (const SceneSample& sample : inputs.samples) {
    const float tolerance_m = BackgroundPlanes::tolerance.at(sample.point_m.z());
    if (std::abs(shadow.ground.plane.height_m(sample.point_m)) > tolerance_m) continue;
    const Rect cell{static_cast<int>(sample.pixel.x()) - cell_px / 2,
                    static_cast<int>(sample.pixel.y()) - cell_px / 2, cell_px, cell_px};
    if (intersect(cell, whole) != cell || shadow.light_at(sample.point_m) < lit) continue;
    int level = 0;
    bool is_camera = true;
    for (int y = cell.y; y < cell.bottom(); ++y) {
      for (int x = cell.x; x < cell.right(); ++x) {
        is_camera &= inputs.provenance(x, y) == provenance::camera;
        level += sum_of(inputs.picture(x, y));
      }
    }
    if (!is_camera) continue;
    const Eigen::Vector2f place = sample.pixel - Eigen::Vector2f(region.x, region.y);
    cells_.push_back({monomials(place.x() / cell_px, place.y() / cell_px),
                      static_cast<float>(level) / full, 1, 1});
  }
  sample_count_ = cells_.size();
}

/// x, y: in cells of the finest scale.
ShadowGain::Field ShadowGain::monomials(float x, float y) const {
  const Scale& fine = scales_.front();
  const auto size = static_cast<float>(std::max(fine.weight.width(), fine.weight.height()));
  x /= size;
  y /= size;
  return Field{{1, x, y, x * x, x * y, y * y}};
}
ShadowGain::Field ShadowGain::monomials(std::size_t scale, int column, int row) const {
  const auto cells = static_cast<float>(1 << scale);
  return monomials(cells * (static_cast<float>(column) + 0.5F),
                   cells * (static_cast<float>(row) + 0.5F));
}

/// Robust least squares over the cells of one scale: at first those without a shadow, then all,
/// without the shadow that is known by then. Also measures the texture.
bool ShadowGain::fit_field(bool only_lit) {
  const Scale& scale = scales_[field_scale];
  cells_.resize(sample_count_);
  for (int row = 0; row < scale.weight.height(); ++row) {
    for (int column = 0; column < scale.weight.width(); ++column) {
      const float weight = scale.weight(column, row);
      if (weight < least_weight) continue;
      const float dark = scale.dark(column, row) / weight;
      if (only_lit && dark > 1 - lit) continue;
      const float light = std::max(1 - scale.gain(column, row) * dark, least_light);
      cells_.push_back({monomials(field_scale, column, row),
                        scale.brightness(column, row) / weight / light, weight, 1});
    }
  }
  if (cells_.size() < fewest_cells) return false;
  for (int pass = 0; pass < robust_passes; ++pass) {
    Eigen::Matrix<float, terms, terms> squares = 1e-4F * Field::Ones().asDiagonal().toDenseMatrix();
    Field products = Field::Zero();
    for (const Cell& cell : cells_) {
      const float weight = cell.weight * cell.trust;
      squares += weight * cell.monomials * cell.monomials.transpose();
      products += weight * cell.brightness * cell.monomials;
    }
    field_ = squares.ldlt().solve(products);
    residuals_.clear();
    for (const Cell& cell : cells_) residuals_.push_back(residual(cell));
    texture_ = std::max(least_texture, 1.48F * median(residuals_));
    for (Cell& cell : cells_) cell.trust = tukey_weight(residual(cell), 4.7F * texture_);
  }
  return true;
}

/// Of the brightness, relative to the field.
float ShadowGain::residual(const Cell& cell) const {
  const float field = std::max(field_.dot(cell.monomials), least_field);
  return std::abs(cell.brightness / field - 1);
}

/// From the coarsest scale to `finest`.
void ShadowGain::find_gains(std::size_t finest) {
  Scale& from = scales_[finest];
  for (int row = 0; row < from.weight.height(); ++row) {
    for (int column = 0; column < from.weight.width(); ++column) {
      const float weight = from.weight(column, row);
      if (weight < least_weight) {
        from.agreement(column, row) = from.square(column, row) = 0;
        continue;
      }
      const float field = std::max(field_.dot(monomials(finest, column, row)), least_field);
      const float brightness = from.brightness(column, row) / weight;
      const float missing = 1 - std::min(brightness / field, most_bright);
      const float dark = from.dark(column, row);
      from.agreement(column, row) = dark * missing;
      from.square(column, row) = dark * dark / weight;
    }
  }
  for (std::size_t i = finest + 1; i < scales; ++i) {
    halve(scales_[i - 1].agreement, scales_[i].agreement);
    halve(scales_[i - 1].square, scales_[i].square);
  }
  const float prior = prior_by_texture * texture_ * texture_;
  for (std::size_t i = scales; i-- > finest;) {
    Scale& scale = scales_[i];
    blur(scale.agreement);
    blur(scale.square);
    for (int row = 0; row < scale.weight.height(); ++row) {
      for (int column = 0; column < scale.weight.width(); ++column) {
        const float coarse = i + 1 < scales ? coarser_gain(i, column, row) : 1;
        const float gain =
            (scale.agreement(column, row) + prior * coarse) / (scale.square(column, row) + prior);
        scale.gain(column, row) = std::clamp(gain, 0.F, most);
      }
    }
  }
}

/// Between the four nearest cells of the next coarser scale.
float ShadowGain::coarser_gain(std::size_t scale, int column, int row) const {
  const Image<float>& gain = scales_[scale + 1].gain;
  const Between columns = between(column, 2, gain.width());
  const Between rows = between(row, 2, gain.height());
  const auto in_row = [&](int y) {
    const float left = gain(columns.first, y);
    return left + columns.share * (gain(columns.second, y) - left);
  };
  const float above = in_row(rows.first);
  return above + rows.share * (in_row(rows.second) - above);
}

/// Two means over five cells along rows, then along columns: nearly a Gaussian of two cells. Beyond
/// the border is 0.
void ShadowGain::blur(Image<float>& image) {
  constexpr int reach = 2;
  constexpr float share = 1.F / (2 * reach + 1);
  const int width = image.width();
  const int height = image.height();
  // A frame of zeros around the image.
  padded_.resize(width + 2 * reach, height + 2 * reach, 0);
  const auto mean_of = [&](const float* first, std::ptrdiff_t step, float* to) {
    for (int x = 0; x < width; ++x) {
      const float* const at = first + x;
      to[x] = share * (at[0] + at[step] + at[2 * step] + at[3 * step] + at[4 * step]);
    }
  };
  const auto pad = [&] {
    for (int row = 0; row < height; ++row) {
      std::copy_n(image.row(row), width, padded_.row(row + reach) + reach);
    }
  };
  for (int pass = 0; pass < 2; ++pass) {
    pad();
    for (int row = 0; row < height; ++row) mean_of(padded_.row(row + reach), 1, image.row(row));
    pad();
    for (int row = 0; row < height; ++row) {
      mean_of(padded_.row(row) + reach, padded_.width(), image.row(row));
    }
  }
}

void ShadowGain::scale_light(std::uint8_t label, Surfaces& surfaces) {
  const Rect& region = surfaces.region;
  const Image<float>& gain = scales_.front().gain;
  const int cells = gain.width();
  const int count = 3 * region.width;
  for_rows(region.height, [&](Rows rows) {
    // Of a row of cells and of the row's channels, in fixed point.
    std::vector<int>& by_cell = by_cell_[rows.band];
    std::vector<std::uint8_t>& by_channel = by_channel_[rows.band];
    by_cell.resize(static_cast<std::size_t>(cells));
    by_channel.resize(static_cast<std::size_t>(count));
    for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
      auto* const levels = reinterpret_cast<std::uint8_t*>(surfaces.light.row(y) + region.x);
      if (find_other(levels, 0, count, 255) == count) continue;
      const Between beside = between(y - region.y, cell_px, gain.height());
      const float* const above = gain.row(beside.first);
      const float* const below = gain.row(beside.second);
      for (int i = 0; i < cells; ++i) {
        by_cell[static_cast<std::size_t>(i)] =
            static_cast<int>(one * (above[i] + beside.share * (below[i] - above[i])));
      }
      spread(by_cell, surfaces.label.row(y) + region.x, label, region.width, by_channel.data());
      scale_row(by_channel.data(), count, levels);
    }
  });
}

}  // namespace diminish
