#include "blend/scraps.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "blend/scraps.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/rows.h"
#include "core/runs.h"
#include "core/small_numbers-inl.h"
#include "depth/row_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// For each pixel how it goes on to its right: Scraps::Link.
void FindLinks(const float* depth_m, int count, const sdct::Threshold& step, std::uint8_t* links) {
  ForEachVector(count, [=](auto d, int x) HWY_ATTR {
    const auto zero = hn::Zero(d);
    const auto own = hn::LoadU(d, depth_m + x);
    const auto next = hn::LoadU(d, depth_m + x + 1);
    const auto most = ThresholdAt(d, step, hn::Min(own, next));
    const auto joins = hn::And(hn::Lt(hn::AbsDiff(own, next), most), hn::Gt(next, zero));
    const auto drawn = hn::IfThenElse(joins, hn::Set(d, static_cast<float>(Scraps::linked)),
                                      hn::Set(d, static_cast<float>(Scraps::last)));
    StoreBytes(d, TruncateSmall(hn::IfThenElseZero(hn::Gt(own, zero), drawn)), links + x);
  });
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(FindLinks);

bool is_step(float a_m, float b_m, const sdct::Threshold& step) {
  return std::abs(a_m - b_m) >= step.at(std::min(a_m, b_m));
}

void clear(int x, int y, Reconstruction& reconstruction) {
  reconstruction.color(x, y) = {};
  reconstruction.depth_m(x, y) = 0;
  reconstruction.source(x, y) = 0;
  SecondView& second = reconstruction.second;
  if (second.share.empty()) return;
  second.color(x, y) = {};
  second.source(x, y) = second.share(x, y) = 0;
}

}  // namespace

void Scraps::find_pieces(const Rect& part, const sdct::Threshold& step,
                         const Image<float>& depth_m) {
  links_.resize(part.width, part.height);
  for_rows(part.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const float* const own = depth_m.row(part.y + y) + part.x;
      std::uint8_t* const links = links_.row(y);
      HWY_DYNAMIC_DISPATCH(FindLinks)(own, part.width - 1, step, links);
      links[part.width - 1] = own[part.width - 1] > 0 ? last : bare;
    }
  });
  pieces_.begin();
  for (int y = 0; y < part.height; ++y) {
    const std::uint8_t* const links = links_.row(y);
    for (int x = 0; (x = find_other(links, x, part.width, bare)) < part.width;) {
      const int end = find_equal(links, x, part.width, last) + 1;
      pieces_.add(y, x, end);
      x = end;
    }
  }
  pieces_.connect(Connectivity::four, [&](const auto& above, const auto& below) {
    const float* const upper = depth_m.row(part.y + above.y) + part.x;
    const float* const lower = depth_m.row(part.y + below.y) + part.x;
    const int end = std::min(above.last, below.last);
    for (int x = std::max(above.first, below.first); x < end; ++x) {
      if (!is_step(upper[x], lower[x], step)) return true;
    }
    return false;
  });
}

void Scraps::remove(const Mask& occlusion, const Rect& surroundings, const sdct::Threshold& step,
                    Reconstruction& reconstruction) {
  const Rect part = intersect(surroundings, reconstruction.region);
  if (part.empty()) return;
  find_pieces(part, step, reconstruction.depth_m);
  const int side = occlusion.width() / squares_across;
  for (const ConnectedRegions::Region& piece : pieces_.regions()) {
    if (piece.pixels >= side * side) continue;
    pieces_.for_each_run(piece, [&](const ConnectedRegions::Run& run) {
      const int y = part.y + run.y;
      for (int x = part.x + run.first; x < part.x + run.last; ++x) {
        if (occlusion(x, y) != 0) clear(x, y, reconstruction);
      }
    });
  }
}

}  // namespace diminish
#endif
