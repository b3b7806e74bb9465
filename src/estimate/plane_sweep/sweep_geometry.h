#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// Planes parallel to a camera's picture, evenly spaced in inverse depth: plane k lies at
/// 1 / (farthest + k * step) metres.
struct SweepPlanes {
  float farthest = 0;  ///< inverse depth of the farthest plane, 1/m
  float step = 0;      ///< 1/m
  int count = 0;

  float inverse_depth(float plane) const { return farthest + plane * step; }
};

/// How pixels move between two pictures without lens distortion, of cameras that are turned alike:
/// the pixel (u, v) of the first, if it shows a point at inverse depth d, is in the second
///   u' = (u + x d) s + (1 - s) cx,  v' = (v + y d) s + (1 - s) cy,  s = 1 / (1 + z d),
/// plus an offset where the two are cut out differently.
/// (The homography that a plane parallel to the picture induces: Hartley & Zisserman, Multiple View
/// Geometry, 13.2.)
struct Parallax {
  float x = 0, y = 0;  ///< pixels times metres
  float z = 0;         ///< metres
  float cx = 0, cy = 0;
  float offset_x = 0, offset_y = 0;

  Parallax() = default;
  /// view: both pictures' pinhole. second_from_first: without the rotation between them.
  Parallax(const Intrinsics& view, const Eigen::Vector3d& second_from_first)
      : x(static_cast<float>(view.fx * second_from_first.x())),
        y(static_cast<float>(view.fy * second_from_first.y())),
        z(static_cast<float>(second_from_first.z())),
        cx(static_cast<float>(view.cx)),
        cy(static_cast<float>(view.cy)) {}

  /// The same for pixels that are counted from these parts' corners.
  Parallax within(const Rect& first, const Rect& second) const {
    Parallax parts = *this;
    parts.cx -= static_cast<float>(first.x);
    parts.cy -= static_cast<float>(first.y);
    parts.offset_x += static_cast<float>(first.x - second.x);
    parts.offset_y += static_cast<float>(first.y - second.y);
    return parts;
  }

  float scale(float inverse_depth) const { return 1 / (1 + z * inverse_depth); }
  /// u' = u * s + shift_x, and v' alike.
  float shift_x(float inverse_depth, float s) const {
    return x * inverse_depth * s + (1 - s) * cx + offset_x;
  }
  float shift_y(float inverse_depth, float s) const {
    return y * inverse_depth * s + (1 - s) * cy + offset_y;
  }

  /// How far a pixel in the middle of the picture moves from one inverse depth to another.
  float path_px(float from, float to) const {
    const float s = scale(from);
    const float t = scale(to);
    return std::hypot(shift_x(to, t) - shift_x(from, s) + (t - s) * cx,
                      shift_y(to, t) - shift_y(from, s) + (t - s) * cy);
  }
  /// The box that holds the second picture's view of `part` between two inverse depths. Nothing
  /// between them may lie behind the second camera.
  Rect reach(const Rect& part, float farthest, float nearest) const {
    float left = 1e9F;
    float right = -1e9F;
    float top = 1e9F;
    float bottom = -1e9F;
    for (const float d : {farthest, nearest}) {
      const float s = scale(d);
      const auto first_x = static_cast<float>(part.x);
      const auto first_y = static_cast<float>(part.y);
      const auto last_x = static_cast<float>(part.right() - 1);
      const auto last_y = static_cast<float>(part.bottom() - 1);
      left = std::min(left, first_x * s + shift_x(d, s));
      right = std::max(right, last_x * s + shift_x(d, s));
      top = std::min(top, first_y * s + shift_y(d, s));
      bottom = std::max(bottom, last_y * s + shift_y(d, s));
    }
    const auto clamp = [](float value) {
      return static_cast<int>(std::floor(std::clamp(value, -32768.F, 32767.F)));
    };
    return {clamp(left), clamp(top), clamp(right) - clamp(left) + 2,
            clamp(bottom) - clamp(top) + 2};
  }
};

}  // namespace diminish
