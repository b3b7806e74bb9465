#include "render/cell_rasterizer.h"

#include <algorithm>
#include <bit>

#include "render/sdct.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/cell_rasterizer.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "depth/row_vectors-inl.h"
#include "render/cell_drawing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

/// Larger cells are drawn with 64-bit numbers.
constexpr int max_cell_px = 64;

/// Vertices at the same corner of neighbouring cells.
struct Corner {
  IntVector x, y;
  Vector depth, inverse_z, u_over_z, v_over_z;
  LaneMask valid;

  HWY_INLINE Corner(const VertexRow& row, int i) {
    const Floats d;
    const Ints di;
    x = hn::LoadU(di, row.x.data() + i);
    y = hn::LoadU(di, row.y.data() + i);
    depth = hn::LoadU(d, row.depth_m.data() + i);
    inverse_z = hn::LoadU(d, row.inverse_z.data() + i);
    u_over_z = hn::LoadU(d, row.u_over_z.data() + i);
    v_over_z = hn::LoadU(d, row.v_over_z.data() + i);
    valid = hn::Gt(inverse_z, hn::Zero(d));
  }
};

HWY_INLINE LaneMask Joined(const Corner& a, const Corner& b, const Corner& c,
                           const sdct::Threshold& threshold) {
  const Vector most = hn::Max(hn::Max(a.depth, b.depth), c.depth);
  const Vector least = hn::Min(hn::Min(a.depth, b.depth), c.depth);
  const Floats d;
  const Vector limit = ThresholdAt(d, threshold, least);
  return hn::And(hn::And(a.valid, b.valid), hn::And(c.valid, hn::Lt(hn::Sub(most, least), limit)));
}

/// Edge functions from a to b, one edge per cell. Coordinates are relative to the cell's first
/// pixel.
struct Edge {
  IntVector step_x, step_y, value;

  HWY_INLINE Edge(IntVector ax, IntVector ay, IntVector bx, IntVector by)
      : step_x(hn::Sub(ay, by)),
        step_y(hn::Sub(bx, ax)),
        value(hn::Neg(hn::Add(hn::Mul(step_x, ax), hn::Mul(step_y, ay)))) {}

  /// A value that is negative where a pixel is outside: edges that are neither top nor left do not
  /// own the pixels on them.
  HWY_INLINE IntVector Biased() const {
    const Ints d;
    const auto zero = hn::Zero(d);
    const auto top_or_left =
        hn::Or(hn::Gt(step_x, zero), hn::And(hn::Eq(step_x, zero), hn::Gt(step_y, zero)));
    return hn::Add(value, hn::IfThenElse(top_or_left, zero, hn::Set(d, -1)));
  }
};

HWY_INLINE void StoreEdge(const Edge& edge, IntVector value, hn::Mask<Ints> exists,
                          LinearFunctions<std::int32_t>& out) {
  const Ints d;
  constexpr int bits = sdct::subpixel_bits;
  hn::Store(hn::IfThenElse(exists, value, hn::Set(d, -1)), d, out.value);
  hn::Store(hn::IfThenElseZero(exists, hn::ShiftLeft<bits>(edge.step_x)), d, out.step_x);
  hn::Store(hn::IfThenElseZero(exists, hn::ShiftLeft<bits>(edge.step_y)), d, out.step_y);
}

/// The plane through the values a, b and c. ea, eb and ec are the opposite edges.
HWY_INLINE void StorePlane(const Edge& ea, const Edge& eb, const Edge& ec, Vector a, Vector b,
                           Vector c, Vector scale, LinearFunctions<float>& out) {
  const Floats d;
  // Not fused, so that every kind of CPU rounds alike (likewise where cells are drawn, and
  // blend_row.cpp): what is nearest, or shown, is decided by these values.
  const auto sum = [&](IntVector wa, IntVector wb, IntVector wc) HWY_ATTR {
    return hn::Add(hn::Mul(hn::ConvertTo(d, wa), a),
                   hn::Add(hn::Mul(hn::ConvertTo(d, wb), b), hn::Mul(hn::ConvertTo(d, wc), c)));
  };
  const Vector pixel_scale = hn::Mul(scale, hn::Set(d, static_cast<float>(sdct::subpixels)));
  hn::Store(hn::Mul(sum(ea.value, eb.value, ec.value), scale), d, out.value);
  hn::Store(hn::Mul(sum(ea.step_x, eb.step_x, ec.step_x), pixel_scale), d, out.step_x);
  hn::Store(hn::Mul(sum(ea.step_y, eb.step_y, ec.step_y), pixel_scale), d, out.step_y);
}

/// The three planes of triangle a b c in each cell.
HWY_INLINE void StorePlanes(const Edge& bc, const Edge& ca, const Edge& ab, const Corner& a,
                            const Corner& b, const Corner& c, IntVector area,
                            LinearFunctions<float> (&out)[3]) {
  const Floats d;
  const Vector scale =
      hn::Div(hn::Set(d, 1.F), hn::ConvertTo(d, hn::Max(area, hn::Set(Ints(), 1))));
  StorePlane(bc, ca, ab, a.inverse_z, b.inverse_z, c.inverse_z, scale, out[0]);
  StorePlane(bc, ca, ab, a.u_over_z, b.u_over_z, c.u_over_z, scale, out[1]);
  StorePlane(bc, ca, ab, a.v_over_z, b.v_over_z, c.v_over_z, scale, out[2]);
}

/// A vertex in a row, by its index.
struct VertexAt {
  const VertexRow& row;
  std::size_t index;

  VertexAt(const VertexRow& row_, int i) : row(row_), index(static_cast<std::size_t>(i)) {}
  std::int64_t x() const { return row.x[index]; }
  std::int64_t y() const { return row.y[index]; }
};

/// Draws a triangle of any size, pixel by pixel with 64-bit numbers, like draw_triangle.
void DrawLarge(const VertexAt (&p)[3], SurfaceBuffer& surface) {
  const std::int64_t area =
      sdct::doubled_area(p[0].x(), p[0].y(), p[1].x(), p[1].y(), p[2].x(), p[2].y());
  if (!sdct::faces_forward(area)) return;
  const float scale = 1.F / static_cast<float>(area);
  const Rect& region = surface.region;
  constexpr int bits = sdct::subpixel_bits;
  const auto [left, right] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
  const auto [top, bottom] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
  const int x0 = std::max(region.x, static_cast<int>((left + sdct::subpixels - 1) >> bits));
  const int x1 = std::min(region.right() - 1, static_cast<int>(right >> bits));
  const int y0 = std::max(region.y, static_cast<int>((top + sdct::subpixels - 1) >> bits));
  const int y1 = std::min(region.bottom() - 1, static_cast<int>(bottom >> bits));
  if (y0 > y1) return;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      float inverse_z = 0;
      float u_over_z = 0;
      float v_over_z = 0;
      bool inside = true;
      for (std::size_t k = 0; k < 3 && inside; ++k) {
        const VertexAt& from = p[(k + 1) % 3];
        const VertexAt& to = p[(k + 2) % 3];
        const std::int64_t step_x = from.y() - to.y();
        const std::int64_t step_y = to.x() - from.x();
        const std::int64_t value = step_x * (std::int64_t{x} * sdct::subpixels - from.x()) +
                                   step_y * (std::int64_t{y} * sdct::subpixels - from.y());
        const bool top_or_left = step_x > 0 || (step_x == 0 && step_y > 0);
        inside = value > 0 || (value == 0 && top_or_left);
        const float weight = static_cast<float>(value) * scale;
        inverse_z += weight * p[k].row.inverse_z[p[k].index];
        u_over_z += weight * p[k].row.u_over_z[p[k].index];
        v_over_z += weight * p[k].row.v_over_z[p[k].index];
      }
      const auto place = static_cast<std::size_t>(surface.row(y) + x - region.x);
      if (!inside || !(inverse_z > surface.inverse_z[place])) continue;
      surface.inverse_z[place] = inverse_z;
      surface.u_over_z[place] = u_over_z;
      surface.v_over_z[place] = v_over_z;
    }
  }
}

HWY_INLINE unsigned Bits(LaneMask mask) {
  alignas(8) std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Floats(), mask, bits);
  return bits[0] & ((1U << hn::Lanes(Floats())) - 1U);
}

void DrawCells(const VertexRow& upper, const VertexRow& lower, int block,
               const sdct::Threshold& threshold, SurfaceBuffer& surface) {
  const Floats d;
  const Ints di;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const Rect region = surface.region;
  Cells cells;
  for (int i = block * VertexRow::block; i < (block + 1) * VertexRow::block; i += lanes) {
    Corner a(upper, i);
    const Corner b(upper, i + 1);
    const Corner c(lower, i);
    Corner e(lower, i + 1);
    LaneMask first = Joined(a, b, c, threshold);
    LaneMask second = Joined(b, e, c, threshold);
    const LaneMask any = hn::Or(first, second);
    if (hn::AllFalse(d, any)) continue;
    // The corner that a single triangle lacks is moved onto one that it has.
    const auto has_first = hn::RebindMask(di, first);
    const auto has_second = hn::RebindMask(di, second);
    a.x = hn::IfThenElse(has_first, a.x, b.x);
    a.y = hn::IfThenElse(has_first, a.y, b.y);
    e.x = hn::IfThenElse(has_second, e.x, b.x);
    e.y = hn::IfThenElse(has_second, e.y, b.y);

    const IntVector left = hn::Min(hn::Min(a.x, b.x), hn::Min(c.x, e.x));
    const IntVector right = hn::Max(hn::Max(a.x, b.x), hn::Max(c.x, e.x));
    const IntVector top = hn::Min(hn::Min(a.y, b.y), hn::Min(c.y, e.y));
    const IntVector bottom = hn::Max(hn::Max(a.y, b.y), hn::Max(c.y, e.y));
    constexpr int bits = sdct::subpixel_bits;
    const IntVector round_up = hn::Set(di, sdct::subpixels - 1);
    const IntVector x0 =
        hn::Max(hn::ShiftRight<bits>(hn::Add(left, round_up)), hn::Set(di, region.x));
    const IntVector x1 = hn::Min(hn::ShiftRight<bits>(right), hn::Set(di, region.right() - 1));
    const IntVector y0 =
        hn::Max(hn::ShiftRight<bits>(hn::Add(top, round_up)), hn::Set(di, region.y));
    const IntVector y1 = hn::Min(hn::ShiftRight<bits>(bottom), hn::Set(di, region.bottom() - 1));
    const LaneMask covers =
        hn::And(any, hn::RebindMask(d, hn::Not(hn::Or(hn::Gt(x0, x1), hn::Gt(y0, y1)))));
    if (hn::AllFalse(d, covers)) continue;
    const IntVector limit = hn::Set(di, max_cell_px * sdct::subpixels);
    const LaneMask fits = hn::RebindMask(
        d, hn::And(hn::Lt(hn::Sub(right, left), limit), hn::Lt(hn::Sub(bottom, top), limit)));
    for (unsigned large = Bits(hn::AndNot(fits, covers)); large != 0; large &= large - 1) {
      const int k = std::countr_zero(large);
      const int at = i + k;
      if ((Bits(first) >> k & 1U) != 0) {
        DrawLarge({{upper, at}, {upper, at + 1}, {lower, at}}, surface);
      }
      if ((Bits(second) >> k & 1U) != 0) {
        DrawLarge({{upper, at + 1}, {lower, at + 1}, {lower, at}}, surface);
      }
    }

    // Relative to each cell's first pixel.
    const LaneMask drawn = hn::And(covers, fits);
    const IntVector base_x = hn::ShiftLeft<bits>(x0);
    const IntVector base_y = hn::ShiftLeft<bits>(y0);
    const IntVector ax = hn::Sub(a.x, base_x), ay = hn::Sub(a.y, base_y);
    const IntVector bx = hn::Sub(b.x, base_x), by = hn::Sub(b.y, base_y);
    const IntVector cx = hn::Sub(c.x, base_x), cy = hn::Sub(c.y, base_y);
    const IntVector ex = hn::Sub(e.x, base_x), ey = hn::Sub(e.y, base_y);
    const auto area = [&](IntVector px, IntVector py, IntVector qx, IntVector qy, IntVector rx,
                          IntVector ry) HWY_ATTR {
      return hn::Sub(hn::Mul(hn::Sub(qx, px), hn::Sub(ry, py)),
                     hn::Mul(hn::Sub(rx, px), hn::Sub(qy, py)));
    };
    const IntVector first_area = area(ax, ay, bx, by, cx, cy);
    const IntVector second_area = area(bx, by, ex, ey, cx, cy);
    first = hn::And(hn::And(first, drawn), hn::RebindMask(d, hn::Gt(first_area, hn::Zero(di))));
    second = hn::And(hn::And(second, drawn), hn::RebindMask(d, hn::Gt(second_area, hn::Zero(di))));
    const unsigned forward = Bits(hn::Or(first, second));
    if (forward == 0) continue;

    const Edge bc(bx, by, cx, cy), ca(cx, cy, ax, ay), ab(ax, ay, bx, by);
    const Edge ec(ex, ey, cx, cy), cb(cx, cy, bx, by), be(bx, by, ex, ey);
    const auto in_first = hn::RebindMask(di, first);
    const auto in_second = hn::RebindMask(di, second);
    // On the diagonal, the two triangles' values are complements of each other.
    StoreEdge(bc, bc.Biased(), hn::RebindMask(di, hn::Or(first, second)), cells.diagonal);
    StoreEdge(ca, ca.Biased(), in_first, cells.first_edges[0]);
    StoreEdge(ab, ab.Biased(), in_first, cells.first_edges[1]);
    StoreEdge(be, be.Biased(), in_second, cells.second_edges[0]);
    StoreEdge(ec, ec.Biased(), in_second, cells.second_edges[1]);
    StorePlanes(bc, ca, ab, a, b, c, first_area, cells.first_planes);
    StorePlanes(ec, cb, be, b, e, c, second_area, cells.second_planes);
    hn::Store(hn::Add(hn::Mul(hn::Sub(y0, hn::Set(di, region.y)),
                              hn::Set(di, static_cast<std::int32_t>(surface.pitch))),
                      hn::Sub(x0, hn::Set(di, region.x))),
              di, cells.place);
    const IntVector one = hn::Set(di, 1);
    hn::Store(hn::Add(hn::Sub(x1, x0), one), di, cells.columns);
    hn::Store(hn::Add(hn::Sub(y1, y0), one), di, cells.rows);
    DrawDrawn(cells, forward, surface);
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(DrawCells);

void draw_cells(const VertexRow& upper, const VertexRow& lower, int block,
                const sdct::Threshold& threshold, SurfaceBuffer& surface) {
  HWY_DYNAMIC_DISPATCH(DrawCells)(upper, lower, block, threshold, surface);
}

}  // namespace diminish
#endif
