#include "core/shrink.h"

#include "core/quick_brightness.h"
#include "core/rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/shrink.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// sums[i]: of `rows` bytes, `pitch` apart, from bytes[i] on.
void SumRows(const std::uint8_t* bytes, std::ptrdiff_t pitch, int rows, int count,
             std::uint16_t* sums) {
  const hn::ScalableTag<std::uint16_t> d;
  const hn::Rebind<std::uint8_t, decltype(d)> d_bytes;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    auto sum = hn::PromoteTo(d, hn::LoadU(d_bytes, bytes + i));
    for (int row = 1; row < rows; ++row) {
      sum = hn::Add(sum, hn::PromoteTo(d, hn::LoadU(d_bytes, bytes + row * pitch + i)));
    }
    hn::StoreU(sum, d, sums + i);
  }
  for (; i < count; ++i) {
    unsigned sum = 0;
    for (int row = 0; row < rows; ++row) sum += bytes[row * pitch + i];
    sums[i] = static_cast<std::uint16_t>(sum);
  }
}

/// means[i]: of `columns` sums, a pixel (3) apart, from sums[i] on, each of `rows` values.
/// Reads up to 3 * columns + a vector beyond the last, and writes up to a vector.
void AverageColumns(const std::uint16_t* sums, int columns, int rows, int count,
                    std::uint8_t* means) {
  const hn::ScalableTag<std::uint16_t> d;
  const hn::RebindToSigned<decltype(d)> d_signed;
  const hn::Rebind<std::uint8_t, decltype(d)> d_bytes;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const int area = columns * rows;
  const auto half = hn::Set(d, static_cast<std::uint16_t>(area / 2));
  const auto divisor = hn::Set(d, static_cast<std::uint16_t>(area));
  const auto largest_remainder = hn::Set(d_signed, static_cast<std::int16_t>(area - 1));
  const auto reciprocal = hn::Set(d, static_cast<std::uint16_t>(65536 / area));
  for (int i = 0; i < count; i += lanes) {
    auto sum = hn::Add(half, hn::LoadU(d, sums + i));
    for (int column = 1; column < columns; ++column) {
      sum = hn::Add(sum, hn::LoadU(d, sums + i + std::ptrdiff_t{3} * column));
    }
    // The reciprocal is at most too small: the quotient is right or one less.
    const auto quotient = hn::MulHigh(sum, reciprocal);
    const auto remainder = hn::BitCast(d_signed, hn::Sub(sum, hn::Mul(quotient, divisor)));
    const auto one_less = hn::VecFromMask(d_signed, hn::Gt(remainder, largest_remainder));
    const auto mean = hn::Sub(hn::BitCast(d_signed, quotient), one_less);
    hn::StoreU(hn::DemoteTo(d_bytes, mean), d_bytes, means + i);
  }
}

constexpr int step = 3 * green_shrinkage;

#if HWY_TARGET != HWY_SCALAR
/// The sums of neighbouring numbers: half as many, twice as wide.
template <class D, class Wide, class V>
HWY_INLINE hn::Vec<Wide> AddPairs(D /*of the numbers*/, Wide wide, V numbers) {
  constexpr int bits = 8 * sizeof(hn::TFromD<D>);
  const auto both = hn::BitCast(wide, numbers);
  const auto even = hn::And(both, hn::Set(wide, static_cast<hn::TFromD<Wide>>((1U << bits) - 1U)));
  return hn::Add(even, hn::ShiftRight<bits>(both));
}

/// The whole vectors of ShrinkGreenRow. Returns their number of pixels.
HWY_INLINE int ShrinkGreenVectors(const std::uint8_t* upper, const std::uint8_t* lower, int count,
                                  std::uint8_t* means) {
  const hn::ScalableTag<std::uint8_t> d;
  const hn::RepartitionToWide<decltype(d)> d16;
  const hn::RepartitionToWide<decltype(d16)> d32;
  const hn::RebindToSigned<decltype(d32)> i32;
  const hn::Rebind<std::uint8_t, decltype(d32)> d8;
  const auto at_once = static_cast<int>(hn::Lanes(d32));
  const auto pairs_of = [&](const std::uint8_t* row) HWY_ATTR {
    hn::Vec<decltype(d)> blue, green, red;
    hn::LoadInterleaved3(d, row, blue, green, red);
    return AddPairs(d, d16, green);
  };
  int x = 0;
  for (; x + at_once <= count; x += at_once) {
    const auto pairs = hn::Add(pairs_of(upper + std::ptrdiff_t{step} * x),
                               pairs_of(lower + std::ptrdiff_t{step} * x));
    const auto sums = hn::Add(AddPairs(d16, d32, pairs), hn::Set(d32, 4));
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(i32, hn::ShiftRight<3>(sums))), d8, means + x);
  }
  return x;
}
#endif

/// The rounded means of 4x2 pixels' green channel.
void ShrinkGreenRow(const std::uint8_t* upper, const std::uint8_t* lower, int count,
                    std::uint8_t* means) {
  int x = 0;
#if HWY_TARGET != HWY_SCALAR
  x = ShrinkGreenVectors(upper, lower, count, means);
#endif
  for (; x < count; ++x) {
    int sum = 4;
    for (int i = 0; i < green_shrinkage; ++i) {
      sum += upper[step * x + 3 * i + 1] + lower[step * x + 3 * i + 1];
    }
    means[x] = static_cast<std::uint8_t>(sum >> 3);
  }
}

/// A row of `shrink_outside`. upper, lower: those of its squares' rows that count; mask: that in
/// their middle.
void ShrinkOutsideRow(const Bgr* upper, const Bgr* lower, const std::uint8_t* mask, int scale,
                      int count, std::uint8_t* levels) {
  const hn::CappedTag<std::int32_t, 16> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const int left = scale / 4;
  const int right = scale - 1 - left;
  int x = 0;
  // Four bytes are read for three of the picture and for one of the mask, which the last pixels do
  // not have.
  for (; x + lanes <= count - 3; x += lanes) {
    const auto column = hn::Mul(hn::Iota(d, x), hn::Set(d, scale));
    const auto offset = hn::Mul(column, hn::Set(d, 3));
    auto blue_red = hn::Zero(d);  // in 16 bits each
    auto green = hn::Zero(d);
    for (const Bgr* pixels : {upper + left, upper + right, lower + left, lower + right}) {
      const auto color = hn::GatherOffset(d, reinterpret_cast<const std::int32_t*>(pixels), offset);
      blue_red = hn::Add(blue_red, hn::And(color, hn::Set(d, 0xFF00FF)));
      green = hn::Add(green, hn::And(hn::ShiftRight<8>(color), hn::Set(d, 0xFF)));
    }
    const auto sum =
        hn::Add(hn::Add(hn::And(blue_red, hn::Set(d, 0xFFFF)), hn::ShiftRight<16>(blue_red)),
                hn::Add(green, green));
    const auto level = hn::Max(hn::Set(d, 1), hn::ShiftRight<4>(sum));
    const auto masked =
        hn::GatherOffset(d, reinterpret_cast<const std::int32_t*>(mask + scale / 2), column);
    const auto is_clear = hn::Eq(hn::And(masked, hn::Set(d, 0xFF)), hn::Zero(d));
    hn::StoreU(hn::DemoteTo(bytes, hn::IfThenElseZero(is_clear, level)), bytes, levels + x);
  }
  for (; x < count; ++x) {
    int sum = 0;
    for (const Bgr* pixels : {upper + left, upper + right, lower + left, lower + right}) {
      sum += quick_brightness(pixels[std::ptrdiff_t{x} * scale]);
    }
    const bool is_masked = mask[x * scale + scale / 2] != 0;
    levels[x] = static_cast<std::uint8_t>(is_masked ? 0 : std::max(1, sum / 16));
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(SumRows);
HWY_EXPORT(AverageColumns);
HWY_EXPORT(ShrinkGreenRow);
HWY_EXPORT(ShrinkOutsideRow);

}  // namespace

void shrink(ImageView<Bgr> image, int scale, const Rect& part, std::vector<std::uint16_t>& scratch,
            Image<Bgr>& small) {
  small.resize(part.width, part.height);
  const int rows = std::min(scale, image.height());
  const int columns = std::min(scale, image.width());
  if (rows * columns == 1) {
    for (int y = 0; y < part.height; ++y) {
      std::copy_n(image.row((part.y + y) * scale) + std::ptrdiff_t{part.x} * scale, part.width,
                  small.row(y));
    }
    return;
  }
  const int count = 3 * part.width * columns;
  constexpr int beyond = 3 * 16 + HWY_MAX_BYTES;
  const std::size_t room = static_cast<std::size_t>(count) + beyond;
  scratch.resize(room + room / 2 + 1);
  auto* const means = reinterpret_cast<std::uint8_t*>(scratch.data() + room);
  for (int y = 0; y < part.height; ++y) {
    const Bgr* const cells = image.row((part.y + y) * scale) + std::ptrdiff_t{part.x} * scale;
    HWY_DYNAMIC_DISPATCH(SumRows)
    (reinterpret_cast<const std::uint8_t*>(cells), image.stride(), rows, count, scratch.data());
    HWY_DYNAMIC_DISPATCH(AverageColumns)(scratch.data(), columns, rows, count, means);
    Bgr* const pixels = small.row(y);
    const std::uint8_t* mean = means;
    for (int x = 0; x < part.width; ++x, mean += std::ptrdiff_t{3} * columns) {
      pixels[x] = {mean[0], mean[1], mean[2]};
    }
  }
}

void shrink_green(ImageView<Bgr> image, Image<std::uint8_t>& small) {
  small.resize(image.width() / green_shrinkage, image.height() / green_shrinkage);
  for_rows(small.height(), [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      // Two of the four rows: half the memory, and noise does no harm here.
      HWY_DYNAMIC_DISPATCH(ShrinkGreenRow)
      (reinterpret_cast<const std::uint8_t*>(image.row(green_shrinkage * y + 1)),
       reinterpret_cast<const std::uint8_t*>(image.row(green_shrinkage * y + 2)), small.width(),
       small.row(y));
    }
  });
}

void shrink_outside(ImageView<Bgr> image, const Mask& mask, int scale, Image<std::uint8_t>& small) {
  small.resize(image.width() / scale, image.height() / scale);
  for (int y = 0; y < small.height(); ++y) {
    const int top = y * scale;
    HWY_DYNAMIC_DISPATCH(ShrinkOutsideRow)
    (image.row(top + scale / 4), image.row(top + scale - 1 - scale / 4), mask.row(top + scale / 2),
     scale, small.width(), small.row(y));
  }
}

}  // namespace diminish
#endif
