#include "composite/color_smoothing.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "core/rows.h"
#include "diminish/diminished_frame.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "composite/color_smoothing.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/small_numbers-inl.h"

// Included once for every instruction set.
#ifndef DIMINISH_COMPOSITE_COLOR_SMOOTHING_ROWS
#define DIMINISH_COMPOSITE_COLOR_SMOOTHING_ROWS
namespace diminish {

// Pointers are to a row's first pixel and to those above and below it; there are
// `ColorSmoothing::reach` pixels to the left and a vector to the right.

/// A row, and those below it, to be compared with its neighbours.
struct ComparedRow {
  static constexpr int rows = ColorSmoothing::reach + 1;
  const std::uint8_t* guide[3][rows];
  const std::uint8_t* seen[rows];
  std::uint8_t* weights[ColorSmoothing::later_count];
};

/// The rows around the one being smoothed.
struct SmoothedRow {
  static constexpr int rows = 2 * ColorSmoothing::reach + 1;
  const std::int16_t* values[3][rows];
  const std::uint8_t* seen;
  /// Of the later neighbours, and of the pixels of which this is the later one.
  const std::uint8_t* later[ColorSmoothing::later_count];
  const std::uint8_t* earlier[ColorSmoothing::later_count];
  std::int16_t share;
};

/// Padding beyond a row's last pixel.
constexpr int padding = 64;

}  // namespace diminish
#endif

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int weight_bits = std::countr_zero(ColorSmoothing::weight_part);
constexpr int quotient_bits = std::countr_zero(ColorSmoothing::one) - 16;
constexpr int share_bits = std::countr_zero(unsigned{ColorSmoothing::whole_change});

using Words = hn::CappedTag<std::int16_t, padding / 2>;
using Bytes = hn::Rebind<std::uint8_t, Words>;
using Floats = hn::CappedTag<float, padding / 4>;

/// Pixels whose neighbours are compared at the same time, in bytes; their colours are summed in
/// words.
constexpr int block = padding / 2;
using AllBytes = hn::CappedTag<std::uint8_t, block>;

/// ColorSmoothing::mean.
struct Division {
  using Unsigned = hn::RebindToUnsigned<Words>;
  hn::Vec<Unsigned> half, inverse;

  HWY_INLINE explicit Division(hn::Vec<Words> weights) {
    const Floats floats;
    const hn::RebindToSigned<Floats> ints;
    const hn::Rebind<std::int16_t, Floats> some;
    const auto one = hn::Set(floats, static_cast<float>(ColorSmoothing::one));
    // Not all instruction sets can widen and narrow half a vector.
    alignas(64) std::int16_t lanes[padding / 2];
    alignas(64) std::uint16_t inverses[padding / 2];
    hn::Store(weights, Words(), lanes);
    for (std::size_t i = 0; i < hn::Lanes(Words()); i += hn::Lanes(floats)) {
      const auto weight = hn::PromoteTo(ints, hn::LoadU(some, lanes + i));
      const auto dividend = hn::Add(one, hn::ConvertTo(floats, hn::ShiftRight<1>(weight)));
      // Exact when rounded down, because the numbers are below 2^24.
      const auto quotient = TruncateSmall(hn::Div(dividend, hn::ConvertTo(floats, weight)));
      const hn::Rebind<std::uint16_t, Floats> to;
      hn::StoreU(hn::DemoteTo(to, quotient), to, inverses + i);
    }
    inverse = hn::Load(Unsigned(), inverses);
    half = hn::BitCast(Unsigned(), hn::ShiftRight<1>(weights));
  }

  HWY_INLINE hn::Vec<Words> operator()(hn::Vec<Words> sum) const {
    const auto rounded = hn::Add(hn::BitCast(Unsigned(), sum), half);
    return hn::BitCast(Words(), hn::ShiftRight<quotient_bits>(hn::MulHigh(rounded, inverse)));
  }
};

HWY_INLINE bool AnySeen(const std::uint8_t* seen) {
  const AllBytes d;
  auto any = hn::Zero(d);
  for (int i = 0; i < block; i += static_cast<int>(hn::Lanes(d))) {
    any = hn::Or(any, hn::LoadU(d, seen + i));
  }
  return !hn::AllTrue(d, hn::Eq(any, hn::Zero(d)));
}

/// The weight of each later neighbour; 0 where one of the two was not seen.
void CompareRow(const ComparedRow& row, int width) {
  const AllBytes d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto largest = hn::Set(d, static_cast<std::uint8_t>(ColorSmoothing::largest_difference));
  // Those beyond the row, which were not seen, are looked at from there.
  for (int first = 0; first < width + ColorSmoothing::reach; first += block) {
    const bool is_any = AnySeen(row.seen[0] + first);
    for (int x = first; x < first + block; x += lanes) {
      hn::Vec<AllBytes> own[3];
      for (int c = 0; c < 3; ++c) own[c] = hn::LoadU(d, row.guide[c][0] + x);
      const auto is_seen = hn::LoadU(d, row.seen[0] + x);
      if (!is_any) {
        for (std::uint8_t* const weights : row.weights) hn::StoreU(hn::Zero(d), d, weights + x);
        continue;
      }
#pragma GCC unroll 10
      for (std::size_t k = 0; k < ColorSmoothing::later.size(); ++k) {
        const ColorSmoothing::Offset offset = ColorSmoothing::later[k];
        auto difference = hn::Zero(d);
        for (int c = 0; c < 3; ++c) {
          const auto other = hn::LoadU(d, row.guide[c][offset.y] + x + offset.x);
          const auto step = hn::Sub(hn::Max(other, own[c]), hn::Min(other, own[c]));
          difference = c == 0 ? step : hn::SaturatedAdd(difference, step);
        }
        const auto both = hn::And(hn::LoadU(d, row.seen[offset.y] + x + offset.x), is_seen);
        const auto left = hn::And(hn::SaturatedSub(largest, difference), both);
        hn::StoreU(hn::ShiftRight<weight_bits>(left), d, row.weights[k] + x);
      }
    }
  }
}

void SmoothRow(const SmoothedRow& row, int width, std::uint8_t* picture) {
  constexpr int reach = ColorSmoothing::reach;
  constexpr auto own_weight =
      static_cast<std::int16_t>(ColorSmoothing::largest_difference / ColorSmoothing::weight_part);
  const Bytes bytes;
  const Words words;
  const auto lanes = static_cast<int>(hn::Lanes(bytes));
  const auto share = hn::Set(words, row.share);
  const auto half = hn::Set(words, std::int16_t{ColorSmoothing::whole_change / 2});
  for (int x = 0; x < width; x += lanes) {
    const auto is_seen = hn::Gt(hn::LoadU(bytes, row.seen + x), hn::Zero(bytes));
    if (hn::AllFalse(bytes, is_seen)) continue;
    auto weights = hn::Set(words, own_weight);
    hn::Vec<Words> sum[3];
    for (int c = 0; c < 3; ++c) {
      sum[c] = hn::Mul(weights, hn::LoadU(words, row.values[c][reach] + x));
    }
    const auto add = [&](const std::uint8_t* weight_row, int dx, int dy) HWY_ATTR {
      const auto weight = hn::PromoteTo(words, hn::LoadU(bytes, weight_row + x));
      weights = hn::Add(weights, weight);
      for (int c = 0; c < 3; ++c) {
        const auto value = hn::LoadU(words, row.values[c][reach + dy] + x + dx);
        sum[c] = hn::Add(sum[c], hn::Mul(weight, value));
      }
    };
#pragma GCC unroll 10
    for (std::size_t k = 0; k < ColorSmoothing::later.size(); ++k) {
      const ColorSmoothing::Offset offset = ColorSmoothing::later[k];
      add(row.later[k], offset.x, offset.y);
      add(row.earlier[k] - offset.x, -offset.x, -offset.y);
    }
    const Division mean(weights);
    hn::Vec<Bytes> result[3];
    for (int c = 0; c < 3; ++c) {
      const auto value = hn::LoadU(words, row.values[c][reach] + x);
      const auto change = hn::Mul(hn::Sub(mean(sum[c]), value), share);
      const auto level = hn::Add(value, hn::ShiftRight<share_bits>(hn::Add(change, half)));
      result[c] = hn::IfThenElse(is_seen, hn::DemoteTo(bytes, level), hn::DemoteTo(bytes, value));
    }
    if (x + lanes <= width) {
      hn::StoreInterleaved3(result[0], result[1], result[2], bytes,
                            picture + 3 * std::ptrdiff_t{x});
    } else {
      std::uint8_t last[3 * padding];
      hn::StoreInterleaved3(result[0], result[1], result[2], bytes, last);
      std::copy_n(last, 3 * (width - x), picture + 3 * std::ptrdiff_t{x});
    }
  }
}

/// The mean of two neighbours and the pixel itself, rounded up twice. A neighbour that was not seen
/// is replaced by the pixel itself.
HWY_INLINE hn::Vec<AllBytes> MeanOfThree(const std::uint8_t* first, const std::uint8_t* first_seen,
                                         const std::uint8_t* second,
                                         const std::uint8_t* second_seen, const std::uint8_t* own) {
  const AllBytes d;
  const auto value = hn::LoadU(d, own);
  const auto among = [&](const std::uint8_t* other, const std::uint8_t* is_seen) HWY_ATTR {
    return hn::IfVecThenElse(hn::LoadU(d, is_seen), hn::LoadU(d, other), value);
  };
  return hn::AverageRound(hn::AverageRound(among(first, first_seen), among(second, second_seen)),
                          value);
}

void AverageAlongRow(const std::uint8_t* values, const std::uint8_t* seen, int width,
                     std::uint8_t* means) {
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(AllBytes()))) {
    const auto mean =
        MeanOfThree(values + x - 1, seen + x - 1, values + x + 1, seen + x + 1, values + x);
    hn::StoreU(mean, AllBytes(), means + x);
  }
}

/// Rows: above, the one to guide, and below.
void MakeGuide(const std::uint8_t* const* means, const std::uint8_t* const* seen, int width,
               std::uint8_t* guide) {
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(AllBytes()))) {
    const auto mean =
        MeanOfThree(means[0] + x, seen[0] + x, means[2] + x, seen[2] + x, means[1] + x);
    hn::StoreU(mean, AllBytes(), guide + x);
  }
}

/// Converts to bytes and to words.
void SplitChannels(const std::uint8_t* pixels, int width, std::uint8_t* const* bytes,
                   std::int16_t* const* words) {
  const Bytes d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    hn::Vec<Bytes> values[3];
    hn::LoadInterleaved3(d, pixels + 3 * std::ptrdiff_t{x}, values[0], values[1], values[2]);
    for (int c = 0; c < 3; ++c) {
      hn::StoreU(values[c], d, bytes[c] + x);
      hn::StoreU(hn::PromoteTo(Words(), values[c]), Words(), words[c] + x);
    }
  }
  for (; x < width; ++x) {
    for (int c = 0; c < 3; ++c) words[c][x] = bytes[c][x] = pixels[3 * x + c];
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(CompareRow);
HWY_EXPORT(SmoothRow);
HWY_EXPORT(SplitChannels);
HWY_EXPORT(AverageAlongRow);
HWY_EXPORT(MakeGuide);

void ColorSmoothing::smooth(const Mask& origins, const Rect& box, int share, Image<Bgr>& picture) {
  if (share == 0) return;
  begin(box);
  for_rows(box.height, [&](Rows rows) {
    Image<std::uint8_t>& values = values_[rows.band];
    values.resize(box.width + reach + padding, 3, 0);
    for (int y = rows.first; y < rows.last; ++y) split_row(origins, picture, box, y, values);
  });
  for_rows(box.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) guide_row(y, box.width);
  });
  for_rows(box.height, [&](Rows rows) {
    // By row, in turn: a row's neighbours above it were compared with it.
    Weights* const weights = weights_[rows.band];
    const auto weights_of = [&](int y) { return &weights[(y + reach) % (reach + 1)]; };
    for (int y = rows.first - reach; y < rows.first; ++y) {
      compare_row(y, box.width, *weights_of(y));
    }
    for (int y = rows.first; y < rows.last; ++y) {
      compare_row(y, box.width, *weights_of(y));
      smooth_row(box, y, {weights_of(y), weights_of(y - 1), weights_of(y - 2)}, share, picture);
    }
  });
}

/// Pixels around the box count as not seen.
void ColorSmoothing::begin(const Rect& box) {
  const int width = box.width + reach + padding;
  const int height = box.height + 2 * reach;
  seen_.resize(width, height);
  for (int c = 0; c < 3; ++c) {
    words_[c].resize(width, height);
    row_means_[c].resize(width, height);
    guide_[c].resize(width, height);
  }
  for (int y = 0; y < height; ++y) {
    const bool is_outside = y < reach || y >= reach + box.height;
    const int end = is_outside ? width : reach;
    const int begin = is_outside ? width : reach + box.width;
    std::fill_n(seen_.row(y), end, std::uint8_t{0});
    std::fill(seen_.row(y) + begin, seen_.row(y) + width, std::uint8_t{0});
  }
}

void ColorSmoothing::split_row(const Mask& origins, const Image<Bgr>& picture, const Rect& box,
                               int y, Image<std::uint8_t>& values) {
  const int width = box.width;
  const std::uint8_t* const origin = origins.row(box.y + y) + box.x;
  std::uint8_t* const seen = seen_.row(y + reach) + reach;
  for (int x = 0; x < width; ++x) {
    const bool is_seen = origin[x] >= provenance::first_rgbd && origin[x] <= provenance::remembered;
    seen[x] = is_seen ? 255 : 0;
  }
  std::uint8_t* channels[3];
  std::int16_t* words[3];
  for (int c = 0; c < 3; ++c) {
    channels[c] = values.row(c) + reach;
    words[c] = words_[c].row(y + reach) + reach;
  }
  HWY_DYNAMIC_DISPATCH(SplitChannels)
  (reinterpret_cast<const std::uint8_t*>(picture.row(box.y + y) + box.x), width, channels, words);
  for (int c = 0; c < 3; ++c) {
    HWY_DYNAMIC_DISPATCH(AverageAlongRow)
    (channels[c], seen, width, row_means_[c].row(y + reach) + reach);
  }
}

void ColorSmoothing::guide_row(int y, int width) {
  const std::uint8_t* seen[3];
  for (int i = 0; i < 3; ++i) seen[i] = seen_.row(y + reach - 1 + i) + reach;
  for (int c = 0; c < 3; ++c) {
    const std::uint8_t* means[3];
    for (int i = 0; i < 3; ++i) means[i] = row_means_[c].row(y + reach - 1 + i) + reach;
    HWY_DYNAMIC_DISPATCH(MakeGuide)(means, seen, width, guide_[c].row(y + reach) + reach);
  }
}

void ColorSmoothing::compare_row(int y, int width, Weights& weights) const {
  weights.resize(reach + width + padding, later_count);
  ComparedRow row{};
  for (int k = 0; k < later_count; ++k) {
    std::fill_n(weights.row(k), reach, std::uint8_t{0});
    row.weights[k] = weights.row(k) + reach;
  }
  if (y < 0) {
    weights.fill(0);
    return;
  }
  for (int i = 0; i < ComparedRow::rows; ++i) {
    row.seen[i] = seen_.row(y + reach + i) + reach;
    for (int c = 0; c < 3; ++c) row.guide[c][i] = guide_[c].row(y + reach + i) + reach;
  }
  HWY_DYNAMIC_DISPATCH(CompareRow)(row, width);
}

void ColorSmoothing::smooth_row(const Rect& box, int y,
                                const std::array<const Weights*, reach + 1>& weights, int share,
                                Image<Bgr>& picture) const {
  SmoothedRow row{};
  row.share = static_cast<std::int16_t>(share);
  row.seen = seen_.row(y + reach) + reach;
  for (int i = 0; i < SmoothedRow::rows; ++i) {
    for (int c = 0; c < 3; ++c) row.values[c][i] = words_[c].row(y + i) + reach;
  }
  for (int k = 0; k < later_count; ++k) {
    const int above = later[static_cast<std::size_t>(k)].y;
    row.later[k] = weights[0]->row(k) + reach;
    row.earlier[k] = weights[static_cast<std::size_t>(above)]->row(k) + reach;
  }
  HWY_DYNAMIC_DISPATCH(SmoothRow)
  (row, box.width, reinterpret_cast<std::uint8_t*>(picture.row(box.y + y) + box.x));
}

}  // namespace diminish
#endif
