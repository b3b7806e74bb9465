#include "membrane/filling_rows.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "membrane/filling_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/small_numbers-inl.h"

// Included once for every instruction set.
#ifndef DIMINISH_MEMBRANE_FILLING_ROWS_CELLS
#define DIMINISH_MEMBRANE_FILLING_ROWS_CELLS
namespace diminish::filling_rows {

/// The first cell of a run to interpolate, and the first to relax.
inline int first_black(Run run, int y) {
  const bool is_single = run.last - run.first == 1;
  return run.first + (is_single ? 0 : (run.first + y + 1) & 1);
}
inline int first_relaxed(Run run, int y, int parity) {
  return run.first + ((run.first + y + parity) & 1);
}

}  // namespace diminish::filling_rows
#endif

HWY_BEFORE_NAMESPACE();
namespace diminish::filling_rows::HWY_NAMESPACE {
namespace {

using diminish::HWY_NAMESPACE::TruncateSmall;

#if HWY_TARGET == HWY_SCALAR || HWY_HAVE_SCALABLE

// A cell is a vector of four.
void Interpolate(std::span<const Run> runs, int y, const Color* near, const Color* far,
                 Color* here) {
  plain::interpolate(runs, y, near, far, here);
}
void Relax(std::span<const Run> runs, int y, int parity, float factor, const Color* above,
           const Color* below, Color* here) {
  plain::relax(runs, y, parity, factor, above, below, here);
}
void Round(const Color* colors, int count, Bgr* pixels) {
  plain::round(colors, count, pixels);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

using One = hn::FixedTag<float, 4>;
/// Two cells, if vectors are long enough: of one colour, so with one of the other between them.
using Two = hn::CappedTag<float, 8>;
constexpr bool has_two = HWY_MAX_BYTES >= 32;

template <class D>
HWY_INLINE hn::Vec<D> Load(D d, const Color* cell) {
  if constexpr (hn::MaxLanes(D()) == 8) {
    return hn::Combine(d, hn::LoadU(One(), cell[2].data()), hn::LoadU(One(), cell[0].data()));
  } else {
    return hn::LoadU(d, cell->data());
  }
}
template <class D>
HWY_INLINE void Store(D d, hn::Vec<D> colors, Color* cell) {
  if constexpr (hn::MaxLanes(D()) == 8) {
    hn::StoreU(hn::LowerHalf(One(), colors), One(), cell[0].data());
    hn::StoreU(hn::UpperHalf(One(), colors), One(), cell[2].data());
  } else {
    hn::StoreU(colors, d, cell->data());
  }
}

/// Calls visit(d, x) for every other cell from column x on: two at a time, then the last.
template <class Visit>
HWY_INLINE void ForEachOther(int x, int last, const Visit& visit) {
  if constexpr (has_two) {
    for (; x + 2 < last; x += 4) visit(Two(), x);
  }
  for (; x < last; x += 2) visit(One(), x);
}

void Interpolate(std::span<const Run> runs, int y, const Color* near, const Color* far,
                 Color* here) {
  for (const Run run : runs) {
    const int first = first_black(run, y);
    const int side = first % 2 == 0 ? -1 : 1;
    ForEachOther(first, run.last, [&](auto d, int x) HWY_ATTR {
      // What is two cells further lies above the next of the coarser cells.
      const auto at = [&](const Color* row, int cell)
                          HWY_ATTR { return hn::LoadU(d, row[cell].data()); };
      const int beside = (x >> 1) + side;
      const auto own = hn::Mul(hn::Set(d, 9.F), at(near, x >> 1));
      const auto next = hn::Mul(hn::Set(d, 3.F), hn::Add(at(near, beside), at(far, x >> 1)));
      const auto sum = hn::Add(hn::Add(own, next), at(far, beside));
      Store(d, hn::Div(sum, hn::Broadcast<3>(sum)), here + x);
    });
  }
}

void Relax(std::span<const Run> runs, int y, int parity, float factor, const Color* above,
           const Color* below, Color* here) {
  for (const Run run : runs) {
    ForEachOther(first_relaxed(run, y, parity), run.last, [&](auto d, int x) HWY_ATTR {
      const auto sum = hn::Add(hn::Add(Load(d, here + x - 1), Load(d, here + x + 1)),
                               hn::Add(Load(d, above + x), Load(d, below + x)));
      const auto weight = hn::Broadcast<3>(sum);
      const auto own = Load(d, here + x);
      auto color = hn::Div(sum, weight);
      if (factor != 1) color = hn::Add(own, hn::Mul(hn::Set(d, factor), hn::Sub(color, own)));
      Store(d, hn::IfThenElse(hn::Eq(weight, hn::Zero(d)), own, color), here + x);
    });
  }
}

void Round(const Color* colors, int count, Bgr* pixels) {
  const hn::CappedTag<float, 8> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  constexpr int at_once = static_cast<int>(hn::MaxLanes(d)) / 4;
  int x = 0;
  // Each writes a byte of the next pixel, too.
  for (; x + at_once < count; x += at_once) {
    const auto color = hn::Add(hn::LoadU(d, colors[x].data()), hn::Set(d, 0.5F));
    std::uint8_t levels[4 * at_once];
    hn::StoreU(hn::DemoteTo(bytes, TruncateSmall(color)), bytes, levels);
    for (int i = 0; i < at_once; ++i) {
      std::memcpy(reinterpret_cast<std::uint8_t*>(pixels + x + i), levels + std::ptrdiff_t{4} * i,
                  4);
    }
  }
  if (x < count) plain::round(colors + x, count - x, pixels + x);
}

#endif

}  // namespace
}  // namespace diminish::filling_rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish::filling_rows {

HWY_EXPORT(Interpolate);
HWY_EXPORT(Relax);
HWY_EXPORT(Round);

void interpolate(std::span<const Run> runs, int y, const Color* near, const Color* far,
                 Color* here) {
  HWY_DYNAMIC_DISPATCH(Interpolate)(runs, y, near, far, here);
}
void relax(std::span<const Run> runs, int y, int parity, float factor, const Color* above,
           const Color* below, Color* here) {
  HWY_DYNAMIC_DISPATCH(Relax)(runs, y, parity, factor, above, below, here);
}
void round(const Color* colors, int count, Bgr* pixels) {
  HWY_DYNAMIC_DISPATCH(Round)(colors, count, pixels);
}

void plain::interpolate(std::span<const Run> runs, int y, const Color* near, const Color* far,
                        Color* here) {
  for (const Run run : runs) {
    for (int x = first_black(run, y); x < run.last; x += 2) {
      const int own = x >> 1;
      const int beside = own + (x % 2 == 0 ? -1 : 1);
      const Color sum = 9 * near[own] + 3 * (near[beside] + far[own]) + far[beside];
      here[x] = sum / Color::Constant(sum[3]);
    }
  }
}

void plain::relax(std::span<const Run> runs, int y, int parity, float factor, const Color* above,
                  const Color* below, Color* here) {
  for (const Run run : runs) {
    for (int x = first_relaxed(run, y, parity); x < run.last; x += 2) {
      const Color sum = (here[x - 1] + here[x + 1]) + (above[x] + below[x]);
      if (sum[3] == 0) continue;
      const Color mean = sum / Color::Constant(sum[3]);
      // The first time there is nothing to start from.
      here[x] = factor == 1 ? mean : here[x] + factor * (mean - here[x]);
    }
  }
}

void plain::round(const Color* colors, int count, Bgr* pixels) {
  for (int x = 0; x < count; ++x) {
    const Eigen::Array4i levels = (colors[x].max(0.F).min(255.F) + 0.5F).cast<int>();
    const auto level = [&](int c) { return static_cast<std::uint8_t>(levels[c]); };
    pixels[x] = {level(0), level(1), level(2)};
  }
}

}  // namespace diminish::filling_rows
#endif
