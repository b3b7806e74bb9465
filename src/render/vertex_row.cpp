#include "render/vertex_row.h"

#include <algorithm>
#include <limits>

#include "render/color_ray.h"
#include "render/sdct.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/vertex_row.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "geometry/projection_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, VertexRow::block>;
using Ints = hn::RebindToSigned<Floats>;
using Vector = hn::Vec<Floats>;
using LaneMask = hn::Mask<Floats>;

HWY_INLINE Vector Set(float value) {
  return hn::Set(Floats(), value);
}

/// One row; the arrays are padded to whole blocks.
template <LensModel model>
void ProjectRowBy(const VertexRows::Constants& constants, const FloatTransform& to_color,
                  const std::uint8_t* visible, int count, const std::uint16_t* depth,
                  const std::uint8_t* mask, const float* ray_x, const float* ray_y,
                  VertexRow& row) {
  const Floats d;
  const Ints di;
  const hn::Rebind<std::uint16_t, Floats> d16;
  const hn::Rebind<std::uint8_t, Floats> d8;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int start = 0; start < count; start += VertexRow::block) {
    const auto index = static_cast<std::size_t>(start / VertexRow::block);
    if (visible[index] == 0) {
      std::fill_n(row.inverse_z.data() + start, VertexRow::block, 0.F);
      row.bounds[index] = {};
      continue;
    }
    LaneMask any = hn::Lt(hn::Zero(d), hn::Zero(d));
    Vector least_x = Set(sdct::max_coordinate_px), greatest_x = Set(-sdct::max_coordinate_px);
    Vector least_y = least_x, greatest_y = greatest_x;
    for (int i = start; i < start + VertexRow::block; i += lanes) {
      hn::Vec<decltype(d16)> values;
      hn::Vec<decltype(d8)> masked;
      if (i + lanes <= count) {
        values = hn::LoadU(d16, depth + i);
        masked = hn::LoadU(d8, mask + i);
      } else {
        HWY_ALIGN std::uint16_t last_values[VertexRow::block] = {};
        HWY_ALIGN std::uint8_t last_masked[VertexRow::block] = {};
        const int rest = std::max(0, count - i);
        std::copy_n(depth + i, rest, last_values);
        std::copy_n(mask + i, rest, last_masked);
        values = hn::LoadU(d16, last_values);
        masked = hn::LoadU(d8, last_masked);
      }
      const auto measured = hn::Ne(hn::PromoteTo(di, values), hn::Zero(di));
      const auto free = hn::Eq(hn::PromoteTo(di, masked), hn::Zero(di));
      LaneMask valid = hn::RebindMask(d, hn::And(measured, free));
      if (hn::AllFalse(d, valid)) {
        hn::StoreU(hn::Zero(d), d, row.inverse_z.data() + i);
        continue;
      }
      const Vector z = hn::Mul(hn::ConvertTo(d, hn::PromoteTo(di, values)), Set(constants.unit_m));
      const Vector x = hn::Mul(hn::LoadU(d, ray_x + i), z);
      const Vector y = hn::Mul(hn::LoadU(d, ray_y + i), z);
      const Vector color_z = Apply(d, to_color, 2, x, y, z);
      valid = hn::And(valid, hn::Gt(color_z, Set(sdct::near_plane_m)));
      Vector px, py;
      valid =
          hn::And(valid, Distort<model>(d, constants.color,
                                        hn::Div(Apply(d, to_color, 0, x, y, z), color_z),
                                        hn::Div(Apply(d, to_color, 1, x, y, z), color_z), px, py));
      const Vector limit = Set(sdct::max_coordinate_px);
      valid = hn::And(valid, hn::And(hn::Lt(hn::Abs(px), limit), hn::Lt(hn::Abs(py), limit)));
      // Invalid values become 0, which can be compared and converted safely.
      px = hn::IfThenElseZero(valid, px);
      py = hn::IfThenElseZero(valid, py);
      const Vector subpixels = Set(static_cast<float>(sdct::subpixels));
      hn::StoreU(hn::NearestInt(hn::Mul(px, subpixels)), di, row.x.data() + i);
      hn::StoreU(hn::NearestInt(hn::Mul(py, subpixels)), di, row.y.data() + i);
      hn::StoreU(z, d, row.depth_m.data() + i);
      hn::StoreU(hn::IfThenElseZero(valid, hn::Div(Set(1.F), color_z)), d,
                 row.inverse_z.data() + i);
      any = hn::Or(any, valid);
      least_x = hn::IfThenElse(valid, hn::Min(least_x, px), least_x);
      greatest_x = hn::IfThenElse(valid, hn::Max(greatest_x, px), greatest_x);
      least_y = hn::IfThenElse(valid, hn::Min(least_y, py), least_y);
      greatest_y = hn::IfThenElse(valid, hn::Max(greatest_y, py), greatest_y);
    }
    if (hn::AllFalse(d, any)) {
      row.bounds[index] = {};
      continue;
    }
    const auto first = [&](Vector values) HWY_ATTR {
      return static_cast<int>(hn::GetLane(hn::MinOfLanes(d, values))) - 1;
    };
    const auto end = [&](Vector values) HWY_ATTR {
      return static_cast<int>(hn::GetLane(hn::MaxOfLanes(d, values))) + 2;
    };
    row.bounds[index] = {first(least_x), first(least_y), end(greatest_x), end(greatest_y)};
  }
}

void ProjectRow(const VertexRows::Constants& constants, const FloatTransform& to_color,
                const std::uint8_t* visible, int count, const std::uint16_t* depth,
                const std::uint8_t* mask, const float* ray_x, const float* ray_y, VertexRow& row) {
  const auto project = [&](auto model) {
    ProjectRowBy<decltype(model)::value>(constants, to_color, visible, count, depth, mask, ray_x,
                                         ray_y, row);
  };
  with_lens_model(constants.color.model, project);
}

/// The places of the colours of one block, which lie on these rays.
template <LensModel model>
void FindColorsBy(const VertexRows::Constants& constants, const float* ray_x, const float* ray_y,
                  const Mask& color_mask, int start, VertexRow& row) {
  const Floats d;
  const Ints di;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int i = start; i < start + VertexRow::block; i += lanes) {
    const Vector inverse_z = hn::LoadU(d, row.inverse_z.data() + i);
    LaneMask valid = hn::Gt(inverse_z, hn::Zero(d));
    if (hn::AllFalse(d, valid)) continue;
    const Vector z = hn::LoadU(d, row.depth_m.data() + i);
    const Vector x = hn::Mul(hn::LoadU(d, ray_x + i - start), z);
    const Vector y = hn::Mul(hn::LoadU(d, ray_y + i - start), z);
    const Vector rgbd_z = Apply(d, constants.to_rgbd_color, 2, x, y, z);
    valid = hn::And(valid, hn::Gt(rgbd_z, Set(sdct::near_plane_m)));
    Vector u, v;
    valid = hn::And(
        valid,
        Distort<model>(d, constants.rgbd_color,
                       hn::Div(Apply(d, constants.to_rgbd_color, 0, x, y, z), rgbd_z),
                       hn::Div(Apply(d, constants.to_rgbd_color, 1, x, y, z), rgbd_z), u, v));
    const Vector zero = hn::Zero(d);
    valid = hn::And(valid, hn::And(hn::And(hn::Ge(u, zero), hn::Le(u, Set(constants.last_column))),
                                   hn::And(hn::Ge(v, zero), hn::Le(v, Set(constants.last_row)))));
    u = hn::IfThenElseZero(valid, u);
    v = hn::IfThenElseZero(valid, v);
    HWY_ALIGN std::int32_t column[VertexRow::block];
    HWY_ALIGN std::int32_t line[VertexRow::block];
    HWY_ALIGN std::int32_t masked[VertexRow::block];
    hn::Store(hn::NearestInt(u), di, column);
    hn::Store(hn::NearestInt(v), di, line);
    for (int k = 0; k < lanes; ++k) masked[k] = color_mask(column[k], line[k]);
    valid = hn::And(valid, hn::RebindMask(d, hn::Eq(hn::Load(di, masked), hn::Zero(di))));
    const Vector kept = hn::IfThenElseZero(valid, inverse_z);
    hn::StoreU(kept, d, row.inverse_z.data() + i);
    hn::StoreU(hn::Mul(u, kept), d, row.u_over_z.data() + i);
    hn::StoreU(hn::Mul(v, kept), d, row.v_over_z.data() + i);
  }
}

void FindColors(const VertexRows::Constants& constants, const float* ray_x, const float* ray_y,
                const Mask& color_mask, int start, VertexRow& row) {
  const auto find = [&](auto model) {
    FindColorsBy<decltype(model)::value>(constants, ray_x, ray_y, color_mask, start, row);
  };
  with_lens_model(constants.rgbd_color.model, find);
}

/// Whether some of a block's pixels, or of those beside them, have no depth. here: the block's
/// first pixel; above, below: those in the rows beside it.
bool HasHoles(const std::uint16_t* above, const std::uint16_t* here, const std::uint16_t* below) {
  const hn::CappedTag<std::uint16_t, VertexRow::block> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  auto least = hn::Set(d, std::numeric_limits<std::uint16_t>::max());
  for (int i = 0; i < VertexRow::block; i += lanes) {
    for (const std::uint16_t* row : {above, here, below, here - 1, here + 1}) {
      least = hn::Min(least, hn::LoadU(d, row + i));
    }
  }
  return !hn::AllFalse(d, hn::Eq(least, hn::Zero(d)));
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(ProjectRow);
HWY_EXPORT(FindColors);
HWY_EXPORT(HasHoles);

void VertexRow::resize(int width) {
  const std::size_t blocks = static_cast<std::size_t>((width + block - 1) / block) + 1;
  const std::size_t size = blocks * block;
  x.resize(size);
  y.resize(size);
  depth_m.resize(size);
  inverse_z.resize(size);
  u_over_z.resize(size);
  v_over_z.resize(size);
  bounds.resize(blocks);
  std::fill_n(inverse_z.end() - block, block, 0.F);
  bounds.back() = {};
}

VertexRows::VertexRows(const RgbdCamera& camera, const Intrinsics& color)
    : rays_(RayTable::of(camera.depth)),
      constants_{Projection(Lens(color)),
                 Projection(Lens(camera.color)),
                 FloatTransform(camera.color_from_depth),
                 static_cast<float>(camera.depth_unit_m),
                 static_cast<float>(camera.color.width - 1),
                 static_cast<float>(camera.color.height - 1)} {
  static_assert(RayTable::block % VertexRow::block == 0);
}

bool VertexRows::may_have_holes(ImageView<std::uint16_t> depth, int first, int row) const {
  const bool at_rim = first < 1 || first + VertexRow::block + 1 > depth.width() || row < 1 ||
                      row + 1 >= depth.height();
  return at_rim ||
         HWY_DYNAMIC_DISPATCH(HasHoles)(depth.row(row - 1) + first, depth.row(row) + first,
                                        depth.row(row + 1) + first);
}

void VertexRows::project(const Frame& frame, int row, VertexRow& vertices) const {
  const int first = frame.first_block * VertexRow::block;
  HWY_DYNAMIC_DISPATCH(ProjectRow)
  (constants_, frame.to_color, frame.visible.row(row) + frame.first_block,
   std::min(frame.blocks * VertexRow::block, width() - first), frame.depth.row(row) + first,
   frame.depth_mask.row(row) + first, rays_->x(row) + first, rays_->y(row) + first, vertices);
  for (int block = 0; block < frame.blocks; ++block) {
    if (vertices.bounds[static_cast<std::size_t>(block)].empty()) continue;
    const int start = block * VertexRow::block;
    const float* const inverse_z = vertices.inverse_z.data() + start;
    float x[VertexRow::block], y[VertexRow::block];
    const float* ray_x = rays_->x(row) + first + start;
    const float* ray_y = rays_->y(row) + first + start;
    if (may_have_holes(frame.depth, first + start, row)) {
      for (int i = 0; i < VertexRow::block; ++i) {
        const Eigen::Vector2f ray = inverse_z[i] > 0
                                        ? color_ray(frame.depth, *rays_, first + start + i, row)
                                        : Eigen::Vector2f(0, 0);
        x[i] = ray.x();
        y[i] = ray.y();
      }
      ray_x = x;
      ray_y = y;
    }
    HWY_DYNAMIC_DISPATCH(FindColors)(constants_, ray_x, ray_y, frame.color_mask, start, vertices);
  }
}

}  // namespace diminish
#endif
