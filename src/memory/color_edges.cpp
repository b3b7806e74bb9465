#include "memory/color_edges.h"

#include <algorithm>
#include <cmath>

#include "core/conditions.h"
#include "core/rows.h"
#include "core/runs.h"

namespace diminish {
namespace {

/// How far from a depth edge the true one may be.
constexpr int band_reach = 4;
/// The side of a block of places; samples are as far apart.
constexpr int block = 3;
/// Of samples, around the picture.
constexpr int margin = VoteSamples::side / 2;

bool is_step(float a, float b) {
  constexpr float smallest = 0.05F;
  return all_of(std::min(a, b) > 0, std::abs(a - b) > smallest * std::max(a, b));
}

/// Of the known ones.
float further(float a, float b) {
  return a > 0 && b > 0 ? std::min(a, b) : std::max(a, b);
}

/// For each block, what `combine` makes of it and those beside it.
template <class Combine>
void combine_blocks(const Combine& combine, Image<float>& blocks) {
  const int width = blocks.width();
  const int height = blocks.height();
  for (int y = 0; y < height; ++y) {
    float* const row = blocks.row(y);
    float before = row[0];
    for (int x = 0; x < width; ++x) {
      const float own = row[x];
      row[x] = combine(combine(before, own), row[std::min(x + 1, width - 1)]);
      before = own;
    }
  }
  for (int x = 0; x < width; ++x) {
    float before = blocks(x, 0);
    for (int y = 0; y < height; ++y) {
      const float own = blocks(x, y);
      blocks(x, y) = combine(combine(before, own), blocks(x, std::min(y + 1, height - 1)));
      before = own;
    }
  }
}

}  // namespace

void ColorEdges::find_band(const Image<float>& inverse_depth) {
  const Rect bounds = inverse_depth.bounds();
  const int width = bounds.width;
  steps_.resize(width, bounds.height);
  across_.resize(width, bounds.height, 0);
  band_.resize(width, bounds.height, 0);
  for (int y = 0; y + 1 < bounds.height; ++y) {
    const float* const own = inverse_depth.row(y);
    const float* const below = inverse_depth.row(y + 1);
    std::uint8_t* const steps = steps_.row(y);
    for (int x = 0; x + 1 < width; ++x) {
      steps[x] = any_of(is_step(own[x], own[x + 1]), is_step(own[x], below[x])) ? 1 : 0;
    }
    std::uint8_t* const across = across_.row(y);
    const int end = width - 1;
    for (int x = find_other(steps, 0, end, 0); x < end; x = find_other(steps, x + 1, end, 0)) {
      const int first = std::max(0, x - band_reach);
      std::fill(across + first, across + std::min(width, x + band_reach + 1), std::uint8_t{1});
    }
  }
  for (int y = 0; y < bounds.height; ++y) {
    std::uint8_t* const band = band_.row(y);
    for (int row = std::max(0, y - band_reach); row < std::min(bounds.height, y + band_reach + 1);
         ++row) {
      const std::uint8_t* const across = across_.row(row);
      for (int x = 0; x < width; ++x) band[x] |= across[x];
    }
  }
}

void ColorEdges::sample(const Image<Bgr>& colors, const Image<float>& inverse_depth) {
  const Rect bounds = inverse_depth.bounds();
  const int width = (bounds.width - 1) / block + 1;
  const int height = (bounds.height - 1) / block + 1;
  for (Image<float>* image : {&far_, &near_}) image->resize(width, height, 0);
  for (Image<float>* image : {&inverse_z_, &blue_, &green_, &red_}) {
    image->resize(width + 2 * margin, height + 2 * margin, 0);
  }
  row_far_.resize(static_cast<std::size_t>(bounds.width));
  row_near_.resize(static_cast<std::size_t>(bounds.width));
  for (int y = 0; y < height; ++y) {
    float* const row_far = row_far_.data();
    float* const row_near = row_near_.data();
    std::copy_n(inverse_depth.row(block * y), bounds.width, row_far);
    std::copy_n(inverse_depth.row(block * y), bounds.width, row_near);
    for (int i = block * y + 1; i < std::min(block * (y + 1), bounds.height); ++i) {
      const float* const own = inverse_depth.row(i);
      for (int x = 0; x < bounds.width; ++x) {
        row_far[x] = further(row_far[x], own[x]);
        row_near[x] = std::max(row_near[x], own[x]);
      }
    }
    for (int x = 0; x < bounds.width; ++x) {
      float& far = far_(x / block, y);
      float& near = near_(x / block, y);
      far = further(far, row_far[x]);
      near = std::max(near, row_near[x]);
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int column = block * x;
      const int row = block * y;
      if (band_(column, row) != 0) continue;
      const Bgr& color = colors(column, row);
      inverse_z_(x + margin, y + margin) = inverse_depth(column, row);
      blue_(x + margin, y + margin) = static_cast<float>(color.b);
      green_(x + margin, y + margin) = static_cast<float>(color.g);
      red_(x + margin, y + margin) = static_cast<float>(color.r);
    }
  }
  combine_blocks(further, far_);
  combine_blocks([](float a, float b) { return std::max(a, b); }, near_);
}

/// In the middle of them, to half their distance.
VoteSamples ColorEdges::samples_around(int x, int y) const {
  const VoteSamples all{inverse_z_.data(), blue_.data(), green_.data(), red_.data(),
                        inverse_z_.width()};
  constexpr int before = VoteSamples::side / 2 - 1;
  return all.from((y / block + margin - before) * all.pitch + x / block + margin - before);
}

void ColorEdges::align(const Image<Bgr>& colors, Image<float>& inverse_depth) {
  const Rect bounds = inverse_depth.bounds();
  before_ = inverse_depth;
  find_band(before_);
  sample(colors, before_);
  for_rows(bounds.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < bounds.width; ++x) {
        if (band_(x, y) == 0) continue;
        const float far = far_(x / block, y / block);
        const float near = near_(x / block, y / block);
        if (!is_step(far, near)) continue;
        const Bgr& color = colors(x, y);
        const SideVotes votes = count_votes(
            samples_around(x, y), {static_cast<float>(color.b), static_cast<float>(color.g),
                                   static_cast<float>(color.r), far, near});
        const int own = before_(x, y) > (near + far) / 2 ? 1 : 0;
        const int other = 1 - own;
        constexpr float fewest = 0.5F;
        if (votes.weight[other] > fewest && votes.weight[other] > 2 * votes.weight[own]) {
          inverse_depth(x, y) = votes.inverse_z[other] / votes.weight[other];
        }
      }
    }
  });
}

}  // namespace diminish
