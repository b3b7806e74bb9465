#include "depth/depth_rows.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "depth/depth_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/small_numbers-inl.h"
#include "depth/row_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::depth_rows::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using diminish::HWY_NAMESPACE::ForEachVector;
using diminish::HWY_NAMESPACE::most_lanes;
using diminish::HWY_NAMESPACE::NoiseAt;
using diminish::HWY_NAMESPACE::StoreBytes;
using diminish::HWY_NAMESPACE::TruncateSmall;

template <class D>
HWY_INLINE hn::Vec<D> Load(D d, const std::uint16_t* depth) {
  const hn::RebindToSigned<D> ints;
  const hn::Rebind<std::uint16_t, D> words;
  return hn::ConvertTo(d, hn::PromoteTo(ints, hn::LoadU(words, depth)));
}
template <class D>
HWY_INLINE void Store(D, hn::Vec<D> values, std::uint16_t* depth) {
  const hn::Rebind<std::uint16_t, D> words;
  hn::StoreU(hn::DemoteTo(words, TruncateSmall(values)), words, depth);
}

/// Whether a surface continues to depth z. first, second: its nearest pixel and the next one.
template <class D>
HWY_INLINE hn::Mask<D> Continues(D d, hn::Vec<D> first, hn::Vec<D> second, hn::Vec<D> z,
                                 hn::Vec<D> noise) {
  const auto zero = hn::Zero(d);
  const auto one = hn::Set(d, 1.F);
  const auto is_near = hn::Le(hn::Abs(hn::Sub(first, z)), hn::Mul(hn::Set(d, 1.5F), noise));
  // Along a plane 1/z changes evenly.
  const auto inverse_first = hn::Div(one, first);
  const auto inverse = hn::IfThenElse(
      hn::Gt(second, zero), hn::Sub(hn::Add(inverse_first, inverse_first), hn::Div(one, second)),
      inverse_first);
  const auto off = hn::Mul(hn::Abs(hn::Sub(one, hn::Mul(inverse, z))), z);
  const auto is_on_plane = hn::Le(off, hn::Mul(hn::Set(d, 2.5F), noise));
  return hn::And(hn::Gt(first, zero), hn::Or(is_near, is_on_plane));
}

void RemoveFlying(const Row& row, std::ptrdiff_t pitch, std::uint16_t* result) {
  ForEachVector(row.count, [&](auto d, int x) HWY_ATTR {
    const std::uint16_t* pixel = row.depth + x;
    const auto unit = hn::Set(d, row.unit_m);
    const auto depth_at = [&](std::ptrdiff_t offset)
                              HWY_ATTR { return hn::Mul(Load(d, pixel + offset), unit); };
    const auto zero = hn::Zero(d);
    const auto z = depth_at(0);
    const auto noise = NoiseAt(d, row.noise, z);
    const auto edge = hn::Mul(hn::Set(d, 2.5F), noise);
    auto flying = hn::Lt(z, zero);
    for (const std::ptrdiff_t offset : {std::ptrdiff_t{1}, std::ptrdiff_t{-1}, pitch, -pitch}) {
      const auto other = depth_at(offset);
      const auto beyond = hn::And(hn::Gt(other, zero), hn::Gt(hn::Abs(hn::Sub(other, z)), edge));
      if (hn::AllFalse(d, beyond)) continue;
      const auto continues = Continues(d, depth_at(-offset), depth_at(-2 * offset), z, noise);
      flying = hn::Or(flying, hn::AndNot(continues, beyond));
    }
    if (hn::AllFalse(d, flying)) return;
    Store(d, hn::IfThenZeroElse(flying, Load(d, result + x)), result + x);
  });
}

/// The frontmost pixel so far: its place in the colour image and its depth.
struct Front {
  float place, depth_m;
};

void RemoveHidden(const Places& places, float unit_m, float margin, float threshold_m, int count,
                  std::uint16_t* depth, float* depth_m, float* place) {
  ForEachVector(count, [&](auto d, int x) HWY_ATTR {
    const auto z = hn::Mul(Load(d, depth + x), hn::Set(d, unit_m));
    const auto ray_x = hn::LoadU(d, places.ray_x + x);
    const auto ray_y = hn::LoadU(d, places.ray_y + x);
    const auto along = [&](int axis) HWY_ATTR {
      const float* const r = places.to_color.r[axis];
      const auto ray =
          hn::Add(hn::Add(hn::Mul(hn::Set(d, r[0]), ray_x), hn::Mul(hn::Set(d, r[1]), ray_y)),
                  hn::Set(d, r[2]));
      return hn::Add(hn::Mul(ray, z), hn::Set(d, places.to_color.t[axis]));
    };
    const auto side = along(0);
    const auto ahead = along(2);
    hn::StoreU(z, d, depth_m + x);
    hn::StoreU(hn::Div(side, hn::Max(ahead, hn::Set(d, 1e-3F))), d, place + x);
  });
  const hn::CappedTag<float, most_lanes> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto threshold = hn::Set(d, threshold_m);
  // From pixel x on, a vector's pixels are measured, in order, and none is far behind the next. So
  // they hide nothing of each other.
  const auto in_order = [&](int x) HWY_ATTR {
    const auto pairs = hn::FirstN(d, static_cast<std::size_t>(lanes - 1));
    const auto z = hn::LoadU(d, depth_m + x);
    const auto next_z = hn::LoadU(d, depth_m + x + 1);
    const auto step = hn::Lt(hn::LoadU(d, place + x), hn::LoadU(d, place + x + 1));
    const auto fits = hn::AndNot(hn::Lt(z, hn::Sub(next_z, threshold)),
                                 hn::Not(hn::Lt(next_z, hn::Sub(z, threshold))));
    const auto all = hn::And(step, fits);
    return hn::AllTrue(d, hn::Or(all, hn::Not(pairs))) && hn::AllTrue(d, hn::Gt(z, hn::Zero(d)));
  };
  // The end of the last whole vector. The rest is done pixel by pixel.
  const int whole = count / lanes * lanes;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const auto pass = [&](int x, float direction, Front& front) {
    if (depth[x] == 0) return;
    const float own = direction * place[x];
    if (front.place > own - margin && front.depth_m < depth_m[x] - threshold_m) {
      depth[x] = 0;
      depth_m[x] = 0;
    } else if (own > front.place) {
      front = {own, depth_m[x]};
    }
  };
  const auto passes_freely = [&](int x, float direction, const Front& front) {
    const float own = direction * place[x];
    return front.place < own &&
           !(front.place > own - margin && front.depth_m < depth_m[x] - threshold_m);
  };
  Front front{-infinity, 0};
  for (int x = 0; x < count;) {
    if (x < whole && x % lanes == 0 && passes_freely(x, 1, front) && in_order(x)) {
      x += lanes;
      front = {place[x - 1], depth_m[x - 1]};
    } else {
      pass(x++, 1, front);
    }
  }
  front = {-infinity, 0};
  for (int x = count; x > 0;) {
    if (x <= whole && x % lanes == 0 && passes_freely(x - 1, -1, front) && in_order(x - lanes)) {
      x -= lanes;
      front = {-place[x], depth_m[x]};
    } else {
      pass(--x, -1, front);
    }
  }
}

void FindJumps(const std::uint16_t* depth, int count, std::ptrdiff_t step, int steps,
               std::uint16_t limit, std::uint8_t* has_jump) {
  const hn::CappedTag<std::uint16_t, piece> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto zero = hn::Zero(d);
  for (int first = 0; first + piece <= count; first += piece) {
    auto widest = zero;
    for (int x = first; x < first + piece; x += lanes) {
      const auto own = hn::LoadU(d, depth + x);
      for (int k = 1; k <= steps; ++k) {
        const auto other = hn::LoadU(d, depth + x + k * step);
        const auto apart = hn::Or(hn::SaturatedSub(own, other), hn::SaturatedSub(other, own));
        // A 0 is the smaller of both.
        widest = hn::Max(widest, hn::IfThenZeroElse(hn::Eq(hn::Min(own, other), zero), apart));
      }
    }
    const auto beyond = hn::SaturatedSub(widest, hn::Set(d, limit));
    has_jump[first / piece] = hn::AllTrue(d, hn::Eq(beyond, zero)) ? 0 : 1;
  }
}

void KeepGaps(const std::uint16_t* depth, std::ptrdiff_t pitch, int count, const Gap& gap,
              std::uint8_t* flags) {
  ForEachVector(count, [&](auto d, int x) HWY_ATTR {
    const hn::Rebind<std::uint8_t, decltype(d)> flag_bytes;
    const auto own_flags = hn::LoadU(flag_bytes, flags + x);
    if (hn::AllTrue(flag_bytes, hn::Eq(own_flags, hn::Zero(flag_bytes)))) return;
    const auto none = hn::Set(d, 65535.F);
    auto least = none;
    auto most = hn::Zero(d);
    for (int row = -reach; row <= reach; ++row) {
      const int side = row == 0 ? reach : row == reach || row == -reach ? 0 : 1;
      for (int column = -side; column <= side; ++column) {
        const auto z = Load(d, depth + x + row * pitch + column);
        least = hn::Min(least, hn::IfThenElse(hn::Gt(z, hn::Zero(d)), z, none));
        most = hn::Max(most, z);
      }
    }
    const auto wide = hn::Max(hn::Set(d, gap.least),
                              hn::Add(hn::Set(d, gap.constant),
                                      hn::Mul(hn::Mul(hn::Set(d, gap.by_square), least), least)));
    const auto has_gap = hn::Gt(hn::Sub(most, least), wide);
    const hn::RebindToSigned<decltype(d)> di;
    const auto old = hn::PromoteTo(di, own_flags);
    StoreBytes(d, hn::IfThenElseZero(hn::RebindMask(di, has_gap), old), flags + x);
  });
}

void LeaveOut(const std::uint16_t* depth, const std::uint8_t* mask, int count,
              std::uint16_t* result) {
  const auto leave_out = [&](auto d, int x) HWY_ATTR {
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const auto is_free = hn::Eq(hn::PromoteTo(d, hn::LoadU(bytes, mask + x)), hn::Zero(d));
    hn::StoreU(hn::IfThenElseZero(is_free, hn::LoadU(d, depth + x)), d, result + x);
  };
  const hn::CappedTag<std::uint16_t, piece> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) leave_out(d, x);
  for (; x < count; ++x) leave_out(hn::CappedTag<std::uint16_t, 1>(), x);
}

void Unite(const std::uint8_t* const* rows, std::size_t row_count, int count,
           std::uint8_t* result) {
  const auto unite = [&](auto d, int x) HWY_ATTR {
    auto bits = hn::LoadU(d, rows[0] + x);
    for (std::size_t k = 1; k < row_count; ++k) bits = hn::Or(bits, hn::LoadU(d, rows[k] + x));
    hn::StoreU(bits, d, result + x);
  };
  const hn::ScalableTag<std::uint8_t> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  if (count < lanes) {
    for (int x = 0; x < count; ++x) unite(hn::CappedTag<std::uint8_t, 1>(), x);
    return;
  }
  for (int x = 0; x + lanes <= count; x += lanes) unite(d, x);
  if (count % lanes != 0) unite(d, count - lanes);
}

}  // namespace
}  // namespace diminish::depth_rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish::depth_rows {
namespace {

HWY_EXPORT(RemoveFlying);
HWY_EXPORT(RemoveHidden);
HWY_EXPORT(FindJumps);
HWY_EXPORT(KeepGaps);
HWY_EXPORT(LeaveOut);
HWY_EXPORT(Unite);

}  // namespace

void remove_flying(const Row& row, std::ptrdiff_t pitch, std::uint16_t* result) {
  HWY_DYNAMIC_DISPATCH(RemoveFlying)(row, pitch, result);
}
void remove_hidden(const Places& places, float unit_m, float margin, float threshold_m, int count,
                   std::uint16_t* depth, float* depth_m, float* place) {
  HWY_DYNAMIC_DISPATCH(RemoveHidden)
  (places, unit_m, margin, threshold_m, count, depth, depth_m, place);
}
void find_jumps(const std::uint16_t* depth, int count, std::ptrdiff_t step, int steps,
                std::uint16_t limit, std::uint8_t* has_jump) {
  HWY_DYNAMIC_DISPATCH(FindJumps)(depth, count, step, steps, limit, has_jump);
}
void keep_gaps(const std::uint16_t* depth, std::ptrdiff_t pitch, int count, const Gap& gap,
               std::uint8_t* flags) {
  HWY_DYNAMIC_DISPATCH(KeepGaps)(depth, pitch, count, gap, flags);
}

void leave_out(const std::uint16_t* depth, const std::uint8_t* mask, int count,
               std::uint16_t* result) {
  HWY_DYNAMIC_DISPATCH(LeaveOut)(depth, mask, count, result);
}
void unite(std::span<const std::uint8_t* const> rows, int count, std::uint8_t* result) {
  HWY_DYNAMIC_DISPATCH(Unite)(rows.data(), rows.size(), count, result);
}

}  // namespace diminish::depth_rows
#endif
