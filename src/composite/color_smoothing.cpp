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

// Included once for every instruction set.
#ifndef DIMINISH_COMPOSITE_COLOR_SMOOTHING_ROWS
#define DIMINISH_COMPOSITE_COLOR_SMOOTHING_ROWS
namespace diminish {

/// The rows around the one being smoothed. Pointers are to its first pixel and to those above and
/// below it; there are `ColorSmoothing::reach` pixels to the left and a vector to the right.
struct SmoothedRow {
  static constexpr int rows = 2 * ColorSmoothing::reach + 1;
  const std::int16_t* values[3][rows];
  const std::uint8_t* guide[3][rows];
  const std::uint8_t* seen[rows];
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
      const auto quotient = hn::ConvertTo(ints, hn::Div(dividend, hn::ConvertTo(floats, weight)));
      const hn::Rebind<std::uint16_t, Floats> to;
      hn::StoreU(hn::DemoteTo(to, quotient), to, inverses + i);
    }
    inverse = hn::Load(Unsigned(), inverses);
    half = hn::BitCast(Unsigned(), hn::ShiftRight<1>(weights));
  }

  HWY_INLINE hn::Vec<Bytes> operator()(hn::Vec<Words> sum) const {
    const auto rounded = hn::Add(hn::BitCast(Unsigned(), sum), half);
    const auto mean = hn::ShiftRight<quotient_bits>(hn::MulHigh(rounded, inverse));
    return hn::DemoteTo(Bytes(), hn::BitCast(Words(), mean));
  }
};

HWY_INLINE bool AnySeen(const SmoothedRow& row, int x) {
  const AllBytes d;
  auto any = hn::Zero(d);
  for (int i = 0; i < block; i += static_cast<int>(hn::Lanes(d))) {
    any = hn::Or(any, hn::LoadU(d, row.seen[ColorSmoothing::reach] + x + i));
  }
  return !hn::AllTrue(d, hn::Eq(any, hn::Zero(d)));
}

/// How alike the first neighbour is for each pixel of the block that begins in column x, then the
/// second, and so on; 0 for neighbours that were not seen.
HWY_INLINE void Compare(const SmoothedRow& row, int x, std::uint8_t* likeness) {
  constexpr int reach = ColorSmoothing::reach;
  const AllBytes d;
  const auto largest = hn::Set(d, static_cast<std::uint8_t>(ColorSmoothing::largest_difference));
  for (int i = 0; i < block; i += static_cast<int>(hn::Lanes(d))) {
    hn::Vec<AllBytes> own[3];
    for (int c = 0; c < 3; ++c) own[c] = hn::LoadU(d, row.guide[c][reach] + x + i);
    std::uint8_t* to = likeness + i;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        if (!ColorSmoothing::is_neighbour(dx, dy)) continue;
        const int at = x + i + dx;
        auto difference = hn::Zero(d);
        for (int c = 0; c < 3; ++c) {
          const auto other = hn::LoadU(d, row.guide[c][reach + dy] + at);
          const auto step = hn::Sub(hn::Max(other, own[c]), hn::Min(other, own[c]));
          difference = c == 0 ? step : hn::SaturatedAdd(difference, step);
        }
        const auto is_seen = hn::LoadU(d, row.seen[reach + dy] + at);
        const auto left = hn::And(hn::SaturatedSub(largest, difference), is_seen);
        hn::Store(left, d, to);
        to += block;
      }
    }
  }
}

void SmoothRow(const SmoothedRow& row, int width, std::uint8_t* picture) {
  constexpr int reach = ColorSmoothing::reach;
  constexpr int square = (2 * reach + 1) * (2 * reach + 1);
  const Bytes bytes;
  const Words words;
  const auto lanes = static_cast<int>(hn::Lanes(bytes));
  HWY_ALIGN std::uint8_t likeness[square * block];
  for (int x = 0; x < width; x += lanes) {
    if (x % block == 0 && AnySeen(row, x)) Compare(row, x, likeness);
    const auto is_seen = hn::Gt(hn::LoadU(bytes, row.seen[reach] + x), hn::Zero(bytes));
    if (hn::AllFalse(bytes, is_seen)) continue;
    const std::uint8_t* own = likeness + x % block;
    hn::Vec<Words> sum[3] = {hn::Zero(words), hn::Zero(words), hn::Zero(words)};
    auto weights = hn::Zero(words);
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        if (!ColorSmoothing::is_neighbour(dx, dy)) continue;
        const auto weight =
            hn::ShiftRight<weight_bits>(hn::PromoteTo(words, hn::LoadU(bytes, own)));
        own += block;
        weights = hn::Add(weights, weight);
        for (int c = 0; c < 3; ++c) {
          const auto value = hn::LoadU(words, row.values[c][reach + dy] + x + dx);
          sum[c] = hn::Add(sum[c], hn::Mul(weight, value));
        }
      }
    }
    // Pixels that were not seen may have no neighbours.
    const Division mean(hn::Max(weights, hn::Set(words, 1)));
    hn::Vec<Bytes> result[3];
    for (int c = 0; c < 3; ++c) {
      const auto value = hn::DemoteTo(bytes, hn::LoadU(words, row.values[c][reach] + x));
      result[c] = hn::IfThenElse(is_seen, mean(sum[c]), value);
    }
    if (x + lanes <= width) {
      hn::StoreInterleaved3(result[0], result[1], result[2], bytes, &picture[3 * x]);
    } else {
      std::uint8_t last[3 * padding];
      hn::StoreInterleaved3(result[0], result[1], result[2], bytes, last);
      std::copy_n(last, 3 * (width - x), &picture[3 * x]);
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
    hn::LoadInterleaved3(d, &pixels[3 * x], values[0], values[1], values[2]);
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

HWY_EXPORT(SmoothRow);
HWY_EXPORT(SplitChannels);
HWY_EXPORT(AverageAlongRow);
HWY_EXPORT(MakeGuide);

void ColorSmoothing::smooth(const Mask& origins, const Rect& box, Image<Bgr>& picture) {
  begin(box);
  for_rows(box.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) split_row(origins, picture, box, y);
  });
  for_rows(box.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) guide_row(y, box.width);
  });
  for_rows(box.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) smooth_row(box, y, picture);
  });
}

/// Pixels around the box count as not seen.
void ColorSmoothing::begin(const Rect& box) {
  const int width = box.width + reach + padding;
  const int height = box.height + 2 * reach;
  seen_.resize(width, height);
  for (int c = 0; c < 3; ++c) {
    values_[c].resize(width, height);
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
                               int y) {
  const int width = box.width;
  const std::uint8_t* const origin = origins.row(box.y + y) + box.x;
  std::uint8_t* const seen = seen_.row(y + reach) + reach;
  for (int x = 0; x < width; ++x) {
    const bool is_seen = origin[x] >= provenance::first_rgbd && origin[x] < provenance::inpainted;
    seen[x] = is_seen ? 255 : 0;
  }
  std::uint8_t* channels[3];
  std::int16_t* words[3];
  for (int c = 0; c < 3; ++c) {
    channels[c] = values_[c].row(y + reach) + reach;
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

void ColorSmoothing::smooth_row(const Rect& box, int y, Image<Bgr>& picture) const {
  SmoothedRow row{};
  for (int i = 0; i < SmoothedRow::rows; ++i) {
    row.seen[i] = seen_.row(y + i) + reach;
    for (int c = 0; c < 3; ++c) {
      row.values[c][i] = words_[c].row(y + i) + reach;
      row.guide[c][i] = guide_[c].row(y + i) + reach;
    }
  }
  HWY_DYNAMIC_DISPATCH(SmoothRow)
  (row, box.width, reinterpret_cast<std::uint8_t*>(picture.row(box.y + y) + box.x));
}

}  // namespace diminish
#endif
