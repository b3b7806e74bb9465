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

  HWY_INLINE Result(const std::int16_t* solution, const Bgra* base, int i) {
    const Bytes d;
    hn::Vec<Shorts> sum[3];
    for (int c = 0; c < 3; ++c) sum[c] = hn::Load(Shorts(), solution + c * block + i);
    if (base) {
      hn::Vec<Bytes> color[4];
      hn::LoadInterleaved4(d, reinterpret_cast<const std::uint8_t*>(base + i), color[0], color[1],
                           color[2], color[3]);
      for (int c = 0; c < 3; ++c) sum[c] = hn::Add(sum[c], hn::PromoteTo(Shorts(), color[c]));
    }
    for (int c = 0; c < 3; ++c) channel[c] = hn::DemoteTo(d, sum[c]);
  }
};

/// One block of pixels. solution: three channels of 32. keys: null if all pixels are to be written.
/// base: null for none.
void WriteBlock(const float* solution, const std::uint8_t* keys, const Bgra* base, Bgr* picture) {
  const Bytes d;
  const hn::Rebind<std::int16_t, Floats> rounded;
  HWY_ALIGN std::int16_t levels[3 * block];
  for (int i = 0; i < 3 * block; i += static_cast<int>(hn::Lanes(rounded))) {
    const auto values = hn::NearestInt(hn::LoadU(Floats(), solution + i));
    hn::Store(hn::DemoteTo(rounded, values), rounded, levels + i);
  }
  for (int i = 0; i < block; i += static_cast<int>(hn::Lanes(d))) {
    Result result(levels, base, i);
    auto* pixels = reinterpret_cast<std::uint8_t*>(picture + i);
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

void write(const MembraneSolver& solver, const Rect& window, const Image<Bgra>* base, Rows rows,
           Image<Bgr>& picture) {
  HWY_ALIGN float solution[3 * block];
  HWY_ALIGN Bgra base_end[block] = {};
  HWY_ALIGN Bgr picture_end[block];
  for (int row = rows.first; row < rows.last; ++row) {
    for (int column = 0; column * block < window.width; ++column) {
      const std::uint32_t cells = solver.cells_in_block(row, column);
      if (cells == 0) continue;
      solver.read_block(row, column, solution);
      const int x = window.x + column * block;
      const int count = std::min(block, window.right() - x);
      const std::uint8_t* keys = cells == ~0U ? nullptr : solver.keys(row) + column * block;
      const Bgra* colors = base ? base->row(window.y + row) + x : nullptr;
      Bgr* pixels = picture.row(window.y + row) + x;
      if (count == block) {
        HWY_DYNAMIC_DISPATCH(WriteBlock)(solution, keys, colors, pixels);
        continue;
      }
      // The last block of a row reaches beyond the images.
      if (base) std::copy_n(colors, count, base_end);
      std::copy_n(pixels, count, picture_end);
      HWY_DYNAMIC_DISPATCH(WriteBlock)
      (solution, keys, base ? static_cast<const Bgra*>(base_end) : nullptr, picture_end);
      std::copy_n(picture_end, count, pixels);
    }
  }
}

}  // namespace

void write_solution(const MembraneSolver& solver, const Rect& window, Image<Bgr>& picture) {
  for_rows(window.height, [&](Rows rows) { write(solver, window, nullptr, rows, picture); });
}
void add_solution(const MembraneSolver& solver, const Rect& window, const Image<Bgra>& base,
                  Image<Bgr>& picture) {
  for_rows(window.height, [&](Rows rows) { write(solver, window, &base, rows, picture); });
}

}  // namespace diminish
#endif
