#include "reconstruct/cell_rasterizer.h"

#include <algorithm>

#include "reconstruct/sdct.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reconstruct/cell_rasterizer.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, VertexRow::block>;
using Ints = hn::RebindToSigned<Floats>;
using Vector = hn::Vec<Floats>;
using IntVector = hn::Vec<Ints>;
using LaneMask = hn::Mask<Floats>;

/// Cells of at most that many pixels a side are drawn together; coordinates in them fit 12 bits.
constexpr int small_cell_px = 8;
/// Larger triangles are drawn in 64 bits.
constexpr int max_medium_px = 64;

/// Vertices of 16 cells that have the same place in their cells.
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

HWY_INLINE LaneMask Joined(const Corner& a, const Corner& b, const Corner& c, Vector threshold) {
  const Vector most = hn::Max(hn::Max(a.depth, b.depth), c.depth);
  const Vector least = hn::Min(hn::Min(a.depth, b.depth), c.depth);
  return hn::And(hn::And(a.valid, b.valid),
                 hn::And(c.valid, hn::Lt(hn::Sub(most, least), threshold)));
}

/// The edge functions from a to b of 16 cells, at a pixel that walks over each cell.
struct Edge {
  IntVector step_x, step_y, value, bias;

  /// Coordinates relative to the walk's first pixel.
  HWY_INLINE Edge(IntVector ax, IntVector ay, IntVector bx, IntVector by) {
    const Ints d;
    step_x = hn::Sub(ay, by);
    step_y = hn::Sub(bx, ax);
    value = hn::Neg(hn::Add(hn::Mul(step_x, ax), hn::Mul(step_y, ay)));
    const auto zero = hn::Zero(d);
    const auto top_or_left =
        hn::Or(hn::Gt(step_x, zero), hn::And(hn::Eq(step_x, zero), hn::Gt(step_y, zero)));
    bias = hn::IfThenElse(top_or_left, zero, hn::Set(d, -1));
  }
};

/// Something that is linear in the picture, on a triangle of each of 16 cells.
struct Plane {
  Vector value, step_x, step_y;

  HWY_INLINE Plane(const Edge& ea, const Edge& eb, const Edge& ec, Vector a, Vector b, Vector c,
                   Vector scale) {
    const Floats d;
    const auto sum = [&](IntVector wa, IntVector wb, IntVector wc) HWY_ATTR {
      return hn::MulAdd(hn::ConvertTo(d, wa), a,
                        hn::MulAdd(hn::ConvertTo(d, wb), b, hn::Mul(hn::ConvertTo(d, wc), c)));
    };
    const Vector pixel_scale = hn::Mul(scale, hn::Set(d, static_cast<float>(sdct::subpixels)));
    value = hn::Mul(sum(ea.value, eb.value, ec.value), scale);
    step_x = hn::Mul(sum(ea.step_x, eb.step_x, ec.step_x), pixel_scale);
    step_y = hn::Mul(sum(ea.step_y, eb.step_y, ec.step_y), pixel_scale);
  }
};

/// The three planes of a triangle of each cell.
struct Surface {
  Plane inverse_z, u_over_z, v_over_z;

  HWY_INLINE Surface(const Edge& ea, const Edge& eb, const Edge& ec, const Corner& a,
                     const Corner& b, const Corner& c, Vector scale)
      : inverse_z(ea, eb, ec, a.inverse_z, b.inverse_z, c.inverse_z, scale),
        u_over_z(ea, eb, ec, a.u_over_z, b.u_over_z, c.u_over_z, scale),
        v_over_z(ea, eb, ec, a.v_over_z, b.v_over_z, c.v_over_z, scale) {}
};

HWY_INLINE void Keep(SurfaceBuffer& surface, std::ptrdiff_t place, float inverse_z, float u_over_z,
                     float v_over_z) {
  float* nearest = surface.inverse_z.data() + place;
  if (!(inverse_z > *nearest)) return;
  *nearest = inverse_z;
  surface.u_over_z[static_cast<std::size_t>(place)] = u_over_z;
  surface.v_over_z[static_cast<std::size_t>(place)] = v_over_z;
}

/// A vertex in a row, by its index.
struct VertexAt {
  const VertexRow& row;
  std::size_t index;

  VertexAt(const VertexRow& row_, int i) : row(row_), index(static_cast<std::size_t>(i)) {}
  std::int64_t x() const { return row.x[index]; }
  std::int64_t y() const { return row.y[index]; }
};

/// A triangle's pixels are looked for inside its bounding box and the region.
struct Box {
  int x0, x1, y0, y1;

  Box(const VertexAt (&p)[3], const Rect& region) {
    constexpr int bits = sdct::subpixel_bits;
    const auto [left, right] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
    const auto [top, bottom] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
    x0 = std::max(region.x, static_cast<int>((left + sdct::subpixels - 1) >> bits));
    x1 = std::min(region.right() - 1, static_cast<int>(right >> bits));
    y0 = std::max(region.y, static_cast<int>((top + sdct::subpixels - 1) >> bits));
    y1 = std::min(region.bottom() - 1, static_cast<int>(bottom >> bits));
    fits_32_bits = std::max(right - left, bottom - top) < max_medium_px * sdct::subpixels;
  }
  bool fits_32_bits;
};

/// A triangle of any size, pixel by pixel in 64 bits, as draw_triangle does.
void DrawLarge(const VertexAt (&p)[3], std::int64_t area, const Box& box, SurfaceBuffer& surface) {
  const float scale = 1.F / static_cast<float>(area);
  for (int y = box.y0; y <= box.y1; ++y) {
    for (int x = box.x0; x <= box.x1; ++x) {
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
      if (inside)
        Keep(surface, surface.row(y) + x - surface.region.x, inverse_z, u_over_z, v_over_z);
    }
  }
}

/// A triangle whose bounding box has less than max_medium_px a side, a vector of pixels at a time.
void DrawMedium(const VertexAt (&p)[3], std::int64_t area, const Box& box, SurfaceBuffer& surface) {
  const Floats d;
  const Ints di;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const float scale = 1.F / static_cast<float>(area);
  // Edge functions at the box's first pixel, with the bias of edges that do not own their pixels.
  std::int32_t value[3], step_x[3], step_y[3];
  float z = 0, u = 0, v = 0, z_x = 0, u_x = 0, v_x = 0, z_y = 0, u_y = 0, v_y = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const VertexAt& from = p[(k + 1) % 3];
    const VertexAt& to = p[(k + 2) % 3];
    const auto dx = static_cast<std::int32_t>(from.y() - to.y());
    const auto dy = static_cast<std::int32_t>(to.x() - from.x());
    const auto at_box = dx * static_cast<std::int32_t>(box.x0 * sdct::subpixels - from.x()) +
                        dy * static_cast<std::int32_t>(box.y0 * sdct::subpixels - from.y());
    value[k] = at_box - (dx > 0 || (dx == 0 && dy > 0) ? 0 : 1);
    step_x[k] = dx * sdct::subpixels;
    step_y[k] = dy * sdct::subpixels;
    const float weight = static_cast<float>(at_box) * scale;
    const float weight_x = static_cast<float>(step_x[k]) * scale;
    const float weight_y = static_cast<float>(step_y[k]) * scale;
    const float vertex_z = p[k].row.inverse_z[p[k].index];
    const float vertex_u = p[k].row.u_over_z[p[k].index];
    const float vertex_v = p[k].row.v_over_z[p[k].index];
    z += weight * vertex_z;
    u += weight * vertex_u;
    v += weight * vertex_v;
    z_x += weight_x * vertex_z;
    u_x += weight_x * vertex_u;
    v_x += weight_x * vertex_v;
    z_y += weight_y * vertex_z;
    u_y += weight_y * vertex_u;
    v_y += weight_y * vertex_v;
  }
  const IntVector iota = hn::Iota(di, 0);
  const Vector float_iota = hn::Iota(d, 0);
  const int width = box.x1 - box.x0 + 1;
  const IntVector minus_one = hn::Set(di, -1);
  for (int y = 0; y <= box.y1 - box.y0; ++y) {
    const std::ptrdiff_t row = surface.row(box.y0 + y) + box.x0 - surface.region.x;
    for (int x = 0; x < width; x += lanes) {
      const auto edge = [&](int k) HWY_ATTR {
        return hn::Add(hn::Set(di, value[k] + y * step_y[k] + x * step_x[k]),
                       hn::Mul(iota, hn::Set(di, step_x[k])));
      };
      const auto in_box = hn::Lt(iota, hn::Set(di, width - x));
      const auto in_triangle = hn::Gt(hn::Or(hn::Or(edge(0), edge(1)), edge(2)), minus_one);
      const LaneMask inside = hn::RebindMask(d, hn::And(in_box, in_triangle));
      if (hn::AllFalse(d, inside)) continue;
      const auto plane = [&](float base, float along_x, float along_y) HWY_ATTR {
        return hn::MulAdd(
            float_iota, hn::Set(d, along_x),
            hn::Set(d, base + static_cast<float>(x) * along_x + static_cast<float>(y) * along_y));
      };
      float* nearest = surface.inverse_z.data() + row + x;
      const Vector old = hn::LoadU(d, nearest);
      const Vector inverse_z = plane(z, z_x, z_y);
      const LaneMask kept = hn::And(inside, hn::Gt(inverse_z, old));
      if (hn::AllFalse(d, kept)) continue;
      hn::StoreU(hn::IfThenElse(kept, inverse_z, old), d, nearest);
      float* const us = surface.u_over_z.data() + row + x;
      float* const vs = surface.v_over_z.data() + row + x;
      hn::StoreU(hn::IfThenElse(kept, plane(u, u_x, u_y), hn::LoadU(d, us)), d, us);
      hn::StoreU(hn::IfThenElse(kept, plane(v, v_x, v_y), hn::LoadU(d, vs)), d, vs);
    }
  }
}

void DrawOne(const VertexAt (&p)[3], SurfaceBuffer& surface) {
  const std::int64_t area =
      sdct::doubled_area(p[0].x(), p[0].y(), p[1].x(), p[1].y(), p[2].x(), p[2].y());
  if (!sdct::faces_forward(area)) return;
  const Box box(p, surface.region);
  if (box.x0 > box.x1 || box.y0 > box.y1) return;
  if (box.fits_32_bits) {
    DrawMedium(p, area, box, surface);
  } else {
    DrawLarge(p, area, box, surface);
  }
}

void DrawCells(const VertexRow& upper, const VertexRow& lower, int block, float threshold_m,
               SurfaceBuffer& surface) {
  const Floats d;
  const Ints di;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const Rect region = surface.region;
  const auto pitch = static_cast<std::int32_t>(surface.pitch);
  constexpr int max_fragments = small_cell_px * small_cell_px * VertexRow::block + VertexRow::block;
  HWY_ALIGN std::int32_t places[max_fragments];
  HWY_ALIGN float values[3][max_fragments];

  for (int i = block * VertexRow::block; i < (block + 1) * VertexRow::block; i += lanes) {
    // a b
    // c e
    Corner a(upper, i);
    const Corner b(upper, i + 1);
    const Corner c(lower, i);
    Corner e(lower, i + 1);
    const Vector threshold = hn::Set(d, threshold_m);
    LaneMask first = Joined(a, b, c, threshold);
    LaneMask second = Joined(b, e, c, threshold);
    const LaneMask any = hn::Or(first, second);
    if (hn::AllFalse(d, any)) continue;
    // The corner that a lone triangle has not is moved onto one that it has.
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
    const IntVector limit = hn::Set(di, small_cell_px * sdct::subpixels);
    const LaneMask small = hn::RebindMask(
        d, hn::And(hn::Lt(hn::Sub(right, left), limit), hn::Lt(hn::Sub(bottom, top), limit)));
    const LaneMask large = hn::AndNot(small, covers);
    if (!hn::AllFalse(d, large)) {
      alignas(8) std::uint8_t which[3][8] = {};
      hn::StoreMaskBits(d, large, which[0]);
      hn::StoreMaskBits(d, first, which[1]);
      hn::StoreMaskBits(d, second, which[2]);
      for (int k = 0; k < lanes; ++k) {
        const auto has = [&](int mask) { return (which[mask][k / 8] >> (k % 8) & 1) != 0; };
        if (!has(0)) continue;
        if (has(1)) DrawOne({{upper, i + k}, {upper, i + k + 1}, {lower, i + k}}, surface);
        if (has(2)) DrawOne({{upper, i + k + 1}, {lower, i + k + 1}, {lower, i + k}}, surface);
      }
    }
    const LaneMask drawn = hn::And(covers, small);
    if (hn::AllFalse(d, drawn)) continue;

    // Relative to each cell's first pixel.
    const IntVector base_x = hn::ShiftLeft<bits>(x0);
    const IntVector base_y = hn::ShiftLeft<bits>(y0);
    const auto relative_x = [&](const Corner& corner) HWY_ATTR {
      return hn::IfThenElseZero(hn::RebindMask(di, drawn), hn::Sub(corner.x, base_x));
    };
    const auto relative_y = [&](const Corner& corner) HWY_ATTR {
      return hn::IfThenElseZero(hn::RebindMask(di, drawn), hn::Sub(corner.y, base_y));
    };
    const IntVector ax = relative_x(a), ay = relative_y(a);
    const IntVector bx = relative_x(b), by = relative_y(b);
    const IntVector cx = relative_x(c), cy = relative_y(c);
    const IntVector ex = relative_x(e), ey = relative_y(e);
    const auto area = [&](IntVector px, IntVector py, IntVector qx, IntVector qy, IntVector rx,
                          IntVector ry) HWY_ATTR {
      return hn::Sub(hn::Mul(hn::Sub(qx, px), hn::Sub(ry, py)),
                     hn::Mul(hn::Sub(rx, px), hn::Sub(qy, py)));
    };
    const IntVector first_area = area(ax, ay, bx, by, cx, cy);
    const IntVector second_area = area(bx, by, ex, ey, cx, cy);
    first = hn::And(hn::And(first, drawn), hn::RebindMask(d, hn::Gt(first_area, hn::Zero(di))));
    second = hn::And(hn::And(second, drawn), hn::RebindMask(d, hn::Gt(second_area, hn::Zero(di))));
    const LaneMask forward = hn::Or(first, second);
    if (hn::AllFalse(d, forward)) continue;
    const auto reciprocal = [&](IntVector value) HWY_ATTR {
      return hn::Div(hn::Set(d, 1.F), hn::ConvertTo(d, hn::Max(value, hn::Set(di, 1))));
    };
    Edge bc(bx, by, cx, cy);
    Edge ca(cx, cy, ax, ay);
    Edge ab(ax, ay, bx, by);
    Edge ec(ex, ey, cx, cy);
    Edge cb(cx, cy, bx, by);
    Edge be(bx, by, ex, ey);
    Surface s1(bc, ca, ab, a, b, c, reciprocal(first_area));
    Surface s2(ec, cb, be, b, e, c, reciprocal(second_area));

    const IntVector one = hn::Set(di, 1);
    const auto count_of = [&](IntVector first_pixel, IntVector last_pixel) HWY_ATTR {
      return hn::IfThenElseZero(hn::RebindMask(di, forward),
                                hn::Add(hn::Sub(last_pixel, first_pixel), one));
    };
    const IntVector columns_of_cell = count_of(x0, x1);
    const IntVector rows_of_cell = count_of(y0, y1);
    const int columns = hn::GetLane(hn::MaxOfLanes(di, columns_of_cell));
    const int rows = hn::GetLane(hn::MaxOfLanes(di, rows_of_cell));
    const IntVector first_place =
        hn::Add(hn::Mul(hn::Sub(y0, hn::Set(di, region.y)), hn::Set(di, pitch)),
                hn::Sub(x0, hn::Set(di, region.x)));
    // The bias belongs to the comparison only: once the planes are set up it can be in the value.
    Edge* const edges[] = {&bc, &ca, &ab, &ec, &cb, &be};
    for (Edge* edge : edges) {
      edge->value = hn::Add(edge->value, edge->bias);
      edge->step_x = hn::ShiftLeft<bits>(edge->step_x);
      edge->step_y = hn::ShiftLeft<bits>(edge->step_y);
    }
    std::size_t count = 0;
    for (int dy = 0; dy < rows; ++dy) {
      const auto in_row = hn::Lt(hn::Set(di, dy), rows_of_cell);
      IntVector e0 = bc.value, e1 = ca.value, e2 = ab.value;
      IntVector e3 = ec.value, e4 = cb.value, e5 = be.value;
      for (int dx = 0; dx < columns; ++dx) {
        const IntVector minus_one = hn::Set(di, -1);
        const auto in_cell = hn::And(in_row, hn::Lt(hn::Set(di, dx), columns_of_cell));
        const LaneMask in_first = hn::And(
            first,
            hn::RebindMask(d, hn::And(in_cell, hn::Gt(hn::Or(hn::Or(e0, e1), e2), minus_one))));
        const LaneMask in_second = hn::And(
            second,
            hn::RebindMask(d, hn::And(in_cell, hn::Gt(hn::Or(hn::Or(e3, e4), e5), minus_one))));
        const LaneMask inside = hn::Or(in_first, in_second);
        if (!hn::AllFalse(d, inside)) {
          const Vector fx = hn::Set(d, static_cast<float>(dx));
          const auto value = [&](const Plane& p, const Plane& q) HWY_ATTR {
            return hn::IfThenElse(in_second, hn::MulAdd(fx, q.step_x, q.value),
                                  hn::MulAdd(fx, p.step_x, p.value));
          };
          const IntVector place = hn::Add(first_place, hn::Set(di, dy * pitch + dx));
          hn::CompressStore(value(s1.inverse_z, s2.inverse_z), inside, d, values[0] + count);
          hn::CompressStore(value(s1.u_over_z, s2.u_over_z), inside, d, values[1] + count);
          hn::CompressStore(value(s1.v_over_z, s2.v_over_z), inside, d, values[2] + count);
          count += hn::CompressStore(place, hn::RebindMask(di, inside), di, places + count);
        }
        e0 = hn::Add(e0, bc.step_x);
        e1 = hn::Add(e1, ca.step_x);
        e2 = hn::Add(e2, ab.step_x);
        e3 = hn::Add(e3, ec.step_x);
        e4 = hn::Add(e4, cb.step_x);
        e5 = hn::Add(e5, be.step_x);
      }
      for (Edge* edge : edges) edge->value = hn::Add(edge->value, edge->step_y);
      for (Surface* s : {&s1, &s2}) {
        for (Plane* plane : {&s->inverse_z, &s->u_over_z, &s->v_over_z}) {
          plane->value = hn::Add(plane->value, plane->step_y);
        }
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      Keep(surface, places[k], values[0][k], values[1][k], values[2][k]);
    }
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(DrawCells);

void SurfaceBuffer::clear(const Rect& region_) {
  region = region_;
  pitch = region.width + VertexRow::block;
  const auto size = static_cast<std::size_t>(pitch) * static_cast<std::size_t>(region.height);
  inverse_z.assign(size, 0.F);
  // Undefined where inverse_z is 0.
  u_over_z.resize(size);
  v_over_z.resize(size);
}

void draw_cells(const VertexRow& upper, const VertexRow& lower, int block, float threshold_m,
                SurfaceBuffer& surface) {
  HWY_DYNAMIC_DISPATCH(DrawCells)(upper, lower, block, threshold_m, surface);
}

}  // namespace diminish
#endif
