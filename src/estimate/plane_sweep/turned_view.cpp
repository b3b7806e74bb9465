#include "estimate/plane_sweep/turned_view.h"

#include <algorithm>
#include <array>

#include "core/rows.h"
#include "core/shrink.h"
#include "diminish/rigid_transform.h"
#include "estimate/plane_sweep/census.h"
#include "geometry/shrunk_camera.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimate/plane_sweep/turned_view.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "geometry/projection_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// The pixels u, v that see the rays (x + i * step, y, 1), turned; negative where there is none.
template <LensModel model>
void ProjectRays(const FloatTransform& turn, const Projection& projection, float x, float step,
                 float y, int count, float* u, float* v) {
  const auto project = [&](auto d, int i) HWY_ATTR {
    const auto ray_x =
        hn::Add(hn::Mul(hn::Iota(d, static_cast<float>(i)), hn::Set(d, step)), hn::Set(d, x));
    const auto ray_y = hn::Set(d, y);
    const auto one = hn::Set(d, 1.F);
    const auto z = Apply(d, turn, 2, ray_x, ray_y, one);
    auto pixel_x = hn::Zero(d);
    auto pixel_y = hn::Zero(d);
    const auto inside =
        Distort<model>(d, projection, hn::Div(Apply(d, turn, 0, ray_x, ray_y, one), z),
                       hn::Div(Apply(d, turn, 1, ray_x, ray_y, one), z), pixel_x, pixel_y);
    const auto seen = hn::And(inside, hn::Gt(z, hn::Set(d, 1e-3F)));
    const auto nowhere = hn::Set(d, -2.F);
    hn::StoreU(hn::IfThenElse(seen, pixel_x, nowhere), d, u + i);
    hn::StoreU(hn::IfThenElse(seen, pixel_y, nowhere), d, v + i);
  };
  const hn::CappedTag<float, 16> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int i = 0;
  for (; i + lanes <= count; i += lanes) project(d, i);
  for (; i < count; ++i) project(hn::CappedTag<float, 1>(), i);
}

void ProjectRow(const FloatTransform& turn, const Projection& projection, float x, float step,
                float y, int count, float* u, float* v) {
  with_lens_model(projection.model, [&](auto chosen) {
    ProjectRays<decltype(chosen)::value>(turn, projection, x, step, y, count, u, v);
  });
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(ProjectRow);

constexpr int most_columns = 16384;
constexpr int at_once = 256;

/// Bilinear, rounded; unknown outside. A picture's pixels are all known.
std::uint8_t look_up(const Image<std::uint8_t>& pixels, float u, float v) {
  if (!(u >= 0 && v >= 0)) return unknown_grey;
  const auto x = static_cast<int>(u);
  const auto y = static_cast<int>(v);
  if (x + 1 >= pixels.width() || y + 1 >= pixels.height()) return unknown_grey;
  const std::uint8_t* const upper = pixels.row(y) + x;
  const std::uint8_t* const lower = upper + pixels.width();
  constexpr int unit = 64;
  const auto right = static_cast<int>((u - static_cast<float>(x)) * unit);
  const auto down = static_cast<int>((v - static_cast<float>(y)) * unit);
  const int above = upper[0] * (unit - right) + upper[1] * right;
  const int below = lower[0] * (unit - right) + lower[1] * right;
  const int sum = above * (unit - down) + below * down;
  return static_cast<std::uint8_t>((sum + unit * unit / 2) / (unit * unit));
}

}  // namespace

GreyPicture::GreyPicture(const Intrinsics& camera, int shrinkage)
    : projection_(Lens(shrunk_camera(camera, shrinkage))), shrinkage_(shrinkage) {}

void GreyPicture::take(ImageView<Bgr> picture) {
  const Rect small = shrunk_bounds(picture, shrinkage_);
  shrink(picture, shrinkage_, small, scratch_, small_);
  pixels_.resize(small.width, small.height);
  for (int y = 0; y < small.height; ++y) {
    const Bgr* const color = small_.row(y);
    std::uint8_t* const grey = pixels_.row(y);
    for (int x = 0; x < small.width; ++x) {
      const int level = (29 * color[x].b + 150 * color[x].g + 77 * color[x].r + 128) >> 8;
      grey[x] = static_cast<std::uint8_t>(std::max(1, level));
    }
  }
}

void turn(const GreyPicture& picture, const Eigen::Matrix3d& camera_from_view,
          const Intrinsics& view, const Rect& window, TurnedView& turned) {
  turned.window = {window.x, window.y, std::min(window.width, most_columns), window.height};
  turned.grey.resize(turned.window.width, window.height);
  const FloatTransform rotation(RigidTransform{camera_from_view, Eigen::Vector3d::Zero()});
  const auto step = static_cast<float>(1 / view.fx);
  for_rows(window.height, [&](Rows rows) {
    std::array<float, at_once> u;
    std::array<float, at_once> v;
    for (int y = rows.first; y < rows.last; ++y) {
      const auto ray_y = static_cast<float>((window.y + y - view.cy) / view.fy);
      for (int first = 0; first < turned.window.width; first += at_once) {
        const int count = std::min(at_once, turned.window.width - first);
        const auto ray_x = static_cast<float>((window.x + first - view.cx) / view.fx);
        HWY_DYNAMIC_DISPATCH(ProjectRow)
        (rotation, picture.projection(), ray_x, step, ray_y, count, u.data(), v.data());
        std::uint8_t* const grey = turned.grey.row(y) + first;
        for (int i = 0; i < count; ++i) {
          const auto at = static_cast<std::size_t>(i);
          grey[i] = look_up(picture.pixels(), u[at], v[at]);
        }
      }
    }
  });
}

void halve(const TurnedView& view, TurnedView& small) {
  small.window = {view.window.x / 2, view.window.y / 2, view.window.width / 2,
                  view.window.height / 2};
  small.grey.resize(small.window.width, small.window.height);
  for (int y = 0; y < small.window.height; ++y) {
    const std::uint8_t* const upper = view.grey.row(2 * y);
    const std::uint8_t* const lower = view.grey.row(2 * y + 1);
    std::uint8_t* const means = small.grey.row(y);
    for (std::ptrdiff_t x = 0; x < small.window.width; ++x) {
      const int a = upper[2 * x];
      const int b = upper[2 * x + 1];
      const int c = lower[2 * x];
      const int d = lower[2 * x + 1];
      const bool known = (a != 0) & (b != 0) & (c != 0) & (d != 0);
      means[x] = known ? static_cast<std::uint8_t>((a + b + c + d + 2) >> 2) : unknown_grey;
    }
  }
}

}  // namespace diminish
#endif
