// Included once for each instruction set: drawing the cells of a block, once their edges and planes
// are known.
#if defined(DIMINISH_CELL_DRAWING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DIMINISH_CELL_DRAWING_INL_H
#undef DIMINISH_CELL_DRAWING_INL_H
#else
#define DIMINISH_CELL_DRAWING_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "render/surface_buffer.h"
#include "render/vertex_row.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Most cells are less than 8 pixels wide.
using Floats = hn::CappedTag<float, 8>;
using Ints = hn::RebindToSigned<Floats>;
using Vector = hn::Vec<Floats>;
using IntVector = hn::Vec<Ints>;
using LaneMask = hn::Mask<Floats>;

/// Functions that are linear in the picture, one cell per lane: the value at the cell's first
/// pixel, and the steps from pixel to pixel.
template <class T>
struct alignas(64) LinearFunctions {
  T value[VertexRow::block], step_x[VertexRow::block], step_y[VertexRow::block];
};

/// What is needed to draw a block's cells. The triangles of a cell
///   a b
///   c e
/// are a b c and b e c; `diagonal` is negative on the second's side.
struct Cells {
  LinearFunctions<std::int32_t> diagonal, first_edges[2], second_edges[2];
  LinearFunctions<float> first_planes[3], second_planes[3];  ///< 1 / z, u / z, v / z
  std::int32_t place[VertexRow::block], columns[VertexRow::block], rows[VertexRow::block];
};

/// One cell's values, the same in each lane.
struct OfOne {
  template <class T, class D = hn::CappedTag<T, 8>>
  static HWY_INLINE hn::Vec<D> Spread(const T* value) {
    return hn::Set(D(), *value);
  }
};

/// A linear function along a few pixels of a row, a pixel in each lane; Of: of whose cells.
template <class Of>
HWY_INLINE IntVector At(const LinearFunctions<std::int32_t>& f, int lane, IntVector x) {
  return hn::Add(Of::Spread(f.value + lane), hn::Mul(x, Of::Spread(f.step_x + lane)));
}
/// Rounded alike on every kind of CPU: not fused.
template <class Of>
HWY_INLINE Vector At(const LinearFunctions<float>& f, int lane, Vector x) {
  return hn::Add(hn::Mul(x, Of::Spread(f.step_x + lane)), Of::Spread(f.value + lane));
}
template <class Of, class V>
struct LinearWalk {
  V value, step_y;

  template <class T>
  HWY_INLINE LinearWalk(const LinearFunctions<T>& f, int lane, V x)
      : value(At<Of>(f, lane, x)), step_y(Of::Spread(f.step_y + lane)) {}
  HWY_INLINE void Down() { value = hn::Add(value, step_y); }
};

/// What a vector of a cell's pixels would show.
struct CellPixels {
  LaneMask outside;
  Vector z, u, v;  ///< 1 / z, u / z, v / z
};

/// Both triangles of a cell along a few pixels of a row, from row to row.
template <class Of>
class CellWalk {
 public:
  HWY_INLINE CellWalk(const Cells& cells, int lane, IntVector x)
      : CellWalk(cells, lane, x, hn::ConvertTo(Floats(), x)) {}

  HWY_INLINE CellPixels Pixels() const {
    const Floats d;
    const Ints di;
    const auto in_second = hn::Lt(diagonal_.value, hn::Zero(di));
    const LaneMask second = hn::RebindMask(d, in_second);
    const IntVector beyond =
        hn::IfThenElse(in_second, hn::Or(be_.value, ec_.value), hn::Or(ca_.value, ab_.value));
    return {hn::RebindMask(d, hn::Lt(beyond, hn::Zero(di))),
            hn::IfThenElse(second, z2_.value, z1_.value),
            hn::IfThenElse(second, u2_.value, u1_.value),
            hn::IfThenElse(second, v2_.value, v1_.value)};
  }
  HWY_INLINE void Down() {
    for (IntWalk* walk : {&diagonal_, &ca_, &ab_, &be_, &ec_}) walk->Down();
    for (FloatWalk* walk : {&z1_, &u1_, &v1_, &z2_, &u2_, &v2_}) walk->Down();
  }

 private:
  using IntWalk = LinearWalk<Of, IntVector>;
  using FloatWalk = LinearWalk<Of, Vector>;

  HWY_INLINE CellWalk(const Cells& cells, int lane, IntVector x, Vector float_x)
      : diagonal_(cells.diagonal, lane, x),
        ca_(cells.first_edges[0], lane, x),
        ab_(cells.first_edges[1], lane, x),
        be_(cells.second_edges[0], lane, x),
        ec_(cells.second_edges[1], lane, x),
        z1_(cells.first_planes[0], lane, float_x),
        u1_(cells.first_planes[1], lane, float_x),
        v1_(cells.first_planes[2], lane, float_x),
        z2_(cells.second_planes[0], lane, float_x),
        u2_(cells.second_planes[1], lane, float_x),
        v2_(cells.second_planes[2], lane, float_x) {}

  IntWalk diagonal_, ca_, ab_, be_, ec_;
  FloatWalk z1_, u1_, v1_, z2_, u2_, v2_;
};

/// Where a cell's pixels are drawn.
struct SurfacePlace {
  float *z, *u, *v;

  HWY_INLINE SurfacePlace(SurfaceBuffer& surface, std::ptrdiff_t place)
      : z(surface.inverse_z.data() + place),
        u(surface.u_over_z.data() + place),
        v(surface.v_over_z.data() + place) {}
  HWY_INLINE void Down(std::ptrdiff_t pitch) {
    z += pitch;
    u += pitch;
    v += pitch;
  }
  template <class D>
  HWY_INLINE void Draw(D d, hn::Mask<D> outside, hn::Vec<D> new_z, hn::Vec<D> new_u,
                       hn::Vec<D> new_v) const {
    const auto old_z = hn::LoadU(d, z);
    const auto kept = hn::AndNot(outside, hn::Gt(new_z, old_z));
    hn::StoreU(hn::IfThenElse(kept, new_z, old_z), d, z);
    hn::StoreU(hn::IfThenElse(kept, new_u, hn::LoadU(d, u)), d, u);
    hn::StoreU(hn::IfThenElse(kept, new_v, hn::LoadU(d, v)), d, v);
  }
};

/// Draws the cell of one lane: both its triangles at once, a vector of pixels at a time.
HWY_INLINE void DrawCell(const Cells& cells, int lane, SurfaceBuffer& surface) {
  const Floats d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < cells.columns[lane]; x += lanes) {
    // hn::Iota of a variable is written to memory lane by lane.
    const IntVector columns = hn::Add(hn::Iota(Ints(), 0), hn::Set(Ints(), x));
    CellWalk<OfOne> walk(cells, lane, columns);
    SurfacePlace place(surface, cells.place[lane] + x);
    for (int rows = cells.rows[lane];;) {
      const CellPixels pixels = walk.Pixels();
      place.Draw(d, pixels.outside, pixels.z, pixels.u, pixels.v);
      if (--rows == 0) break;
      walk.Down();
      place.Down(surface.pitch);
    }
  }
}

#if HWY_TARGET != HWY_SCALAR && !HWY_HAVE_SCALABLE && HWY_MAX_BYTES >= 32
/// Cells that are no wider than half a vector are drawn two at a time.
constexpr int most_pair_columns = 4;
/// How many more rows than its neighbour a cell of a pair may have: rows beyond the lower end of
/// the other, in which nothing of it lies, are read and written back.
constexpr int most_rows_more = SurfaceBuffer::rows_beyond;

/// One cell's values in the lower and the next one's in the upper half.
struct OfTwo {
  template <class T, class D = hn::CappedTag<T, 8>>
  static HWY_INLINE hn::Vec<D> Spread(const T* values) {
    HWY_ALIGN static constexpr std::int32_t lanes[8] = {0, 0, 0, 0, 1, 1, 1, 1};
    return hn::TableLookupLanes(hn::LoadU(D(), values), hn::SetTableIndices(D(), lanes));
  }
};

/// Whether the cells of a lane and the next are drawn by DrawPair.
HWY_INLINE bool IsPair(const Cells& cells, int lane) {
  return std::max(cells.columns[lane], cells.columns[lane + 1]) <= most_pair_columns &&
         std::abs(cells.rows[lane] - cells.rows[lane + 1]) <= most_rows_more;
}

/// DrawCell for the cells of a lane and the next, one after the other in each row.
HWY_INLINE void DrawPair(const Cells& cells, int lane, SurfaceBuffer& surface) {
  const Floats d;
  const Ints di;
  const hn::Half<Floats> half;
  CellWalk<OfTwo> walk(cells, lane, hn::And(hn::Iota(di, 0), hn::Set(di, most_pair_columns - 1)));
  SurfacePlace first(surface, cells.place[lane]), second(surface, cells.place[lane + 1]);
  for (int rows = std::max(cells.rows[lane], cells.rows[lane + 1]);;) {
    const CellPixels pixels = walk.Pixels();
    const Vector outside = hn::VecFromMask(d, pixels.outside);
    // They may share pixels.
    first.Draw(half, hn::MaskFromVec(hn::LowerHalf(half, outside)), hn::LowerHalf(half, pixels.z),
               hn::LowerHalf(half, pixels.u), hn::LowerHalf(half, pixels.v));
    second.Draw(half, hn::MaskFromVec(hn::UpperHalf(half, outside)), hn::UpperHalf(half, pixels.z),
                hn::UpperHalf(half, pixels.u), hn::UpperHalf(half, pixels.v));
    if (--rows == 0) break;
    walk.Down();
    first.Down(surface.pitch);
    second.Down(surface.pitch);
  }
}
#endif

/// Draws the cells of the lanes whose bits are set.
HWY_INLINE void DrawDrawn(const Cells& cells, unsigned bits, SurfaceBuffer& surface) {
  while (bits != 0) {
    const int lane = std::countr_zero(bits);
#if HWY_TARGET != HWY_SCALAR && !HWY_HAVE_SCALABLE && HWY_MAX_BYTES >= 32
    if ((bits >> lane & 2U) != 0 && IsPair(cells, lane)) {
      DrawPair(cells, lane, surface);
      bits &= ~(3U << lane);
      continue;
    }
#endif
    DrawCell(cells, lane, surface);
    bits &= bits - 1;
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
