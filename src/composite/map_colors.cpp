#include "composite/map_colors.h"

#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "composite/map_colors.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/small_numbers-inl.h"

// Included once for every instruction set.
#ifndef DIMINISH_COMPOSITE_MAP_COLORS_ROW
#define DIMINISH_COMPOSITE_MAP_COLORS_ROW
namespace diminish {

/// Consecutive pixels of one row, starting at column x.
struct MappedRow {
  const Bgra* colors;
  const std::uint8_t* sources;
  const std::uint8_t* occlusion;
  const SoftMembrane::Node* correction;
  const std::uint8_t* shares;  ///< the colour's share in the picture, in 1/255; null: all of it
  Bgr* picture;
  int x, y, count;
};

}  // namespace diminish
#endif

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Within a block the correction is linear.
constexpr int block = SoftMembrane::cell;
using Floats = hn::CappedTag<float, block>;
using Ints = hn::RebindToSigned<Floats>;
using Bytes = hn::Rebind<std::uint8_t, Floats>;
using Vector = hn::Vec<Floats>;
/// Interleaved bytes are taken apart as many at a time as fill a vector, or a block.
using AllBytes = hn::CappedTag<std::uint8_t, block>;
constexpr int part_count = static_cast<int>(hn::MaxLanes(AllBytes()) / hn::MaxLanes(Floats()));

HWY_INLINE Vector Set(float value) {
  return hn::Set(Floats(), value);
}
HWY_INLINE Vector ToFloats(hn::Vec<Bytes> bytes) {
  return hn::ConvertTo(Floats(), hn::PromoteTo(Ints(), bytes));
}

/// The bytes of one, two or four vectors, one after the other.
template <class Part>
HWY_INLINE Part Joined(const Part (&parts)[1]) {
  return parts[0];
}
#if HWY_TARGET != HWY_SCALAR
template <class Part>
HWY_INLINE hn::Vec<AllBytes> Joined(const Part (&parts)[2]) {
  return hn::Combine(AllBytes(), parts[1], parts[0]);
}
template <class Part>
HWY_INLINE hn::Vec<AllBytes> Joined(const Part (&parts)[4]) {
  const hn::Half<AllBytes> half;
  return hn::Combine(AllBytes(), hn::Combine(half, parts[3], parts[2]),
                     hn::Combine(half, parts[1], parts[0]));
}
#endif

/// A map, ready for a row.
struct RowMap {
  /// The field is a quadratic polynomial of the column.
  Vector constant, linear, square, scale;
  Vector matrix[3][3], offset[3];
  float center_x, scale_x;

  RowMap(const ColorMap& map, int y) {
    scale_x = 1 / map.half_width;
    center_x = map.center.x();
    const float v = (static_cast<float>(y) - map.center.y()) * scale_x;
    constant = Set(1 + map.field[1] * v + map.field[4] * v * v);
    linear = Set(map.field[0] + map.field[3] * v);
    square = Set(map.field[2]);
    scale = Set(scale_x);
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 3; ++k) matrix[c][k] = Set(map.matrix(c, k));
      offset[c] = Set(map.offset[c]);
    }
  }
};

/// As many pixels as a vector has bytes from column i of the row on, of which `chosen` are written.
HWY_INLINE void MapPixels(const RowMap& map, const MappedRow& row, int i,
                          hn::Mask<AllBytes> chosen) {
  const Bytes bytes;
  const AllBytes all;
  const auto lanes = static_cast<int>(hn::Lanes(bytes));
  hn::Vec<AllBytes> colors[4];
  hn::LoadInterleaved4(all, reinterpret_cast<const std::uint8_t*>(row.colors + i), colors[0],
                       colors[1], colors[2], colors[3]);
  auto* pixels = reinterpret_cast<std::uint8_t*>(row.picture + i);
  hn::Vec<AllBytes> old[3];
  hn::LoadInterleaved3(all, pixels, old[0], old[1], old[2]);
  // To be read in parts.
  HWY_ALIGN std::uint8_t color[3][block];
  HWY_ALIGN std::uint8_t before[3][block];
  for (int c = 0; c < 3; ++c) {
    hn::Store(colors[c], all, color[c]);
    hn::Store(old[c], all, before[c]);
  }
  const SoftMembrane::Node& left = row.correction[i / block];
  const SoftMembrane::Node slope = (row.correction[i / block + 1] - left) / block;
  hn::Vec<Bytes> result[3][part_count];
  for (int part = 0; part < part_count; ++part) {
    const int at = part * lanes;
    const auto load = [&](const std::uint8_t* from)
                          HWY_ATTR { return ToFloats(hn::LoadU(bytes, from + at)); };
    const Vector blue = load(color[0]);
    const Vector green = load(color[1]);
    const Vector red = load(color[2]);
    const Vector first = Set((static_cast<float>(row.x + i + at) - map.center_x) * map.scale_x);
    const Vector u = hn::MulAdd(hn::Iota(Floats(), 0), map.scale, first);
    const Vector place = hn::Iota(Floats(), static_cast<float>(i % block + at));
    Vector field = hn::MulAdd(hn::MulAdd(map.square, u, map.linear), u, map.constant);
    field = hn::Min(hn::Max(field, Set(ColorMap::least_field)), Set(ColorMap::greatest_field));
    for (int c = 0; c < 3; ++c) {
      Vector sum = hn::MulAdd(map.matrix[c][0], blue, map.offset[c]);
      sum = hn::MulAdd(map.matrix[c][1], green, sum);
      sum = hn::MulAdd(map.matrix[c][2], red, sum);
      const Vector correction = hn::Add(Set(left[c]), hn::Mul(place, Set(slope[c])));
      sum = hn::MulAdd(field, sum, correction);
      auto level = hn::DemoteTo(bytes, NearestSmall(sum));
      if (row.shares) {
        const Vector share = hn::Mul(load(row.shares + i), Set(1 / 255.F));
        const Vector own = load(before[c]);
        const Vector mixed = hn::MulAdd(share, hn::Sub(ToFloats(level), own), own);
        level = hn::DemoteTo(bytes, NearestSmall(mixed));
      }
      result[c][part] = level;
    }
  }
  hn::Vec<AllBytes> mapped[3];
  for (int c = 0; c < 3; ++c) mapped[c] = hn::IfThenElse(chosen, Joined(result[c]), old[c]);
  hn::StoreInterleaved3(mapped[0], mapped[1], mapped[2], all, pixels);
}

/// `count` is a multiple of a block. maps: by source.
void MapRow(const ColorMap* maps, const MappedRow& row) {
  const AllBytes bytes;
  const auto lanes = static_cast<int>(hn::Lanes(bytes));
  int last_source = -1;
  RowMap map(ColorMap(), row.y);
  for (int i = 0; i < row.count; i += lanes) {
    const auto sources = hn::LoadU(bytes, row.sources + i);
    const auto wanted = hn::AndNot(hn::Eq(sources, hn::Zero(bytes)),
                                   hn::Ne(hn::LoadU(bytes, row.occlusion + i), hn::Zero(bytes)));
    // A vector nearly always has one camera.
    auto left = wanted;
    while (!hn::AllFalse(bytes, left)) {
      const std::uint8_t source = row.sources[i + hn::FindFirstTrue(bytes, left)];
      const auto own = hn::And(left, hn::Eq(sources, hn::Set(bytes, source)));
      if (source != last_source) map = RowMap(maps[source], row.y);
      last_source = source;
      MapPixels(map, row, i, own);
      left = hn::AndNot(own, left);
    }
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(MapRow);

/// Allows any `row.count`.
void map_row(ColorMapsBySource maps, MappedRow row) {
  constexpr int block = SoftMembrane::cell;
  const int rest = row.count % block;
  row.count -= rest;
  HWY_DYNAMIC_DISPATCH(MapRow)(maps.data(), row);
  if (rest == 0) return;
  // The last pixels of a row, beyond which nothing may be read.
  const int whole = row.count;
  Bgra colors[block] = {};
  std::uint8_t sources[block] = {};
  std::uint8_t mask[block] = {};
  std::uint8_t shares[block] = {};
  Bgr pixels[block] = {};
  std::copy_n(row.colors + whole, rest, colors);
  std::copy_n(row.sources + whole, rest, sources);
  std::copy_n(row.occlusion + whole, rest, mask);
  if (row.shares) std::copy_n(row.shares + whole, rest, shares);
  std::copy_n(row.picture + whole, rest, pixels);
  HWY_DYNAMIC_DISPATCH(MapRow)
  (maps.data(), {colors, sources, mask, row.correction + whole / block,
                 row.shares ? shares : nullptr, pixels, row.x + whole, row.y, block});
  std::copy_n(pixels, rest, row.picture + whole);
}

}  // namespace

void map_colors(ColorMapsBySource maps, const Reconstruction& reconstruction, const Mask& occlusion,
                int y, const SoftMembrane::Node* correction, Image<Bgr>& picture) {
  const Rect& region = reconstruction.region;
  MappedRow row{reconstruction.color.row(y) + region.x,
                reconstruction.source.row(y) + region.x,
                occlusion.row(y) + region.x,
                correction,
                nullptr,
                picture.row(y) + region.x,
                region.x,
                y,
                region.width};
  map_row(maps, row);
  const SecondView& second = reconstruction.second;
  if (second.share.empty()) return;
  row.colors = second.color.row(y) + region.x;
  row.sources = second.source.row(y) + region.x;
  row.shares = second.share.row(y) + region.x;
  map_row(maps, row);
}

}  // namespace diminish
#endif
