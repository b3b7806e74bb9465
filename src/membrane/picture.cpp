#include "membrane/picture.h"

#include <algorithm>

#include "core/rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "membrane/picture.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int block = MembraneLevel::tile_width;
using Floats = hn::CappedTag<float, block>;
using Shorts = hn::CappedTag<std::int16_t, block>;
using Bytes = hn::Rebind<std::uint8_t, Shorts>;

/// The three channels of some pixels of a block, from pixel i on, rounded, with those of `base`
/// added, if there is one; clamped.
struct Result {
  hn::Vec<Bytes> channel[3];

  HWY_INLINE Result(const std::int16_t* solution, const std::uint8_t* base, int base_channels,
                    int i) {
    const Bytes d;
    hn::Vec<Shorts> sum[3];
    for (int c = 0; c < 3; ++c) sum[c] = hn::Load(Shorts(), solution + c * block + i);
    if (base) {
      hn::Vec<Bytes> color[4];
      if (base_channels == 4) {
        hn::LoadInterleaved4(d, base + 4 * i, color[0], color[1], color[2], color[3]);
      } else {
        hn::LoadInterleaved3(d, base + 3 * i, color[0], color[1], color[2]);
      }
      for (int c = 0; c < 3; ++c) sum[c] = hn::Add(sum[c], hn::PromoteTo(Shorts(), color[c]));
    }
    for (int c = 0; c < 3; ++c) channel[c] = hn::DemoteTo(d, sum[c]);
  }
};

/// One block of pixels. solution: three channels of 32. keys: null if all pixels are to be written.
/// base: null for none.
void WriteBlock(const float* solution, const std::uint8_t* keys, const std::uint8_t* base,
                int base_channels, std::uint8_t* picture) {
  const Bytes d;
  const hn::Rebind<std::int16_t, Floats> rounded;
  HWY_ALIGN std::int16_t levels[3 * block];
  for (int i = 0; i < 3 * block; i += static_cast<int>(hn::Lanes(rounded))) {
    const auto values = hn::NearestInt(hn::LoadU(Floats(), solution + i));
    hn::Store(hn::DemoteTo(rounded, values), rounded, levels + i);
  }
  for (int i = 0; i < block; i += static_cast<int>(hn::Lanes(d))) {
    Result result(levels, base, base_channels, i);
    std::uint8_t* const pixels = picture + 3 * i;
    if (keys) {
      const auto key = hn::LoadU(d, keys + i);
      const auto skipped =
          hn::Or(hn::Eq(key, hn::Zero(d)), hn::Eq(key, hn::Set(d, MembraneSolver::fixed)));
      if (hn::AllTrue(d, skipped)) continue;
      hn::Vec<Bytes> old[3];
      hn::LoadInterleaved3(d, pixels, old[0], old[1], old[2]);
      for (int c = 0; c < 3; ++c) {
        result.channel[c] = hn::IfThenElse(skipped, old[c], result.channel[c]);
      }
    }
    hn::StoreInterleaved3(result.channel[0], result.channel[1], result.channel[2], d, pixels);
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(WriteBlock);

constexpr int block = MembraneLevel::tile_width;

void write(const MembraneSolver& solver, const Membrane::ConstView& base, Rows rows,
           const Membrane::View& window) {
  HWY_ALIGN float solution[3 * block];
  HWY_ALIGN std::uint8_t base_end[4 * block] = {};
  HWY_ALIGN std::uint8_t picture_end[3 * block] = {};
  for (int y = rows.first; y < rows.last; ++y) {
    for (int column = 0; column * block < window.width; ++column) {
      const std::uint32_t cells = solver.cells_in_block(y, column);
      if (cells == 0) continue;
      solver.read_block(y, column, solution);
      const int x = column * block;
      const int count = std::min(block, window.width - x);
      const std::uint8_t* keys = cells == ~0U ? nullptr : solver.keys(y) + x;
      const std::uint8_t* colors = base.data ? base.pixel(x, y) : nullptr;
      std::uint8_t* const pixels = window.pixel(x, y);
      if (count == block) {
        HWY_DYNAMIC_DISPATCH(WriteBlock)(solution, keys, colors, base.channels, pixels);
        continue;
      }
      // The last block of a row reaches beyond the images.
      if (colors) {
        std::copy_n(colors, base.channels * count, base_end);
        colors = base_end;
      }
      std::copy_n(pixels, 3 * count, picture_end);
      HWY_DYNAMIC_DISPATCH(WriteBlock)(solution, keys, colors, base.channels, picture_end);
      std::copy_n(picture_end, 3 * count, pixels);
    }
  }
}

}  // namespace

void write_solution(const MembraneSolver& solver, const Membrane::View& window) {
  for_rows(window.height, [&](Rows rows) { write(solver, {}, rows, window); });
}
void add_solution(const MembraneSolver& solver, const Membrane::ConstView& base,
                  const Membrane::View& window) {
  for_rows(window.height, [&](Rows rows) { write(solver, base, rows, window); });
}

}  // namespace diminish
#endif
