#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace diminish {

/// How much of a plane's light comes from where, by the shadows on it.
///
/// The plane's brightness is a smooth field, quadratic in its coordinates, times the light that is
/// left, and that is
///
///   light(p) = 1 - sum over directions d of  share_d hidden_d(p)
///
/// where hidden_d(p) says that something stands between p and the light from d. Field and shares,
/// none of them negative, follow from the brightness by robust alternating least squares (Sato,
/// Sato & Ikeuchi 2003, "Illumination from shadows").
class ShadowFit {
 public:
  /// Some light comes from everywhere.
  static constexpr float least_light = 0.15F;

  /// Starts without points.
  void begin(std::size_t directions);
  /// place: on the plane. levels: its colour. hidden: the directions from which something hides it.
  void add(const Eigen::Vector2f& place, const Eigen::Array3f& levels,
           const std::vector<std::uint8_t>& hidden);
  std::size_t size() const { return points_.size(); }

  /// Whether shadows explain the brightness: much better than none, taking no more light away than
  /// objects on a plane can, and about as much of each channel. Cost: about 1 us a point.
  bool fit();
  /// By channel, of the light of one direction. After fit().
  Eigen::Array3f share(std::size_t direction) const;

 private:
  static constexpr int brightness = 3;  ///< a fourth channel: the mean of all
  /// x^a y^b of a place (x, y), up to a + b = 4; those up to 2 first, which the field consists of.
  using Monomials = Eigen::Array<float, 16, 1>;
  struct Point {
    Monomials monomials;
    Eigen::Array4f levels;
    std::uint32_t first_hidden, last_hidden;  ///< in hidden_
    float weight, light, field;
  };

  void sort_by_direction();
  void fit_field(int channel);
  void weigh(float end_in_shadow);
  void fit_shares(int channel);
  const float* column(std::size_t direction);
  void find_light();
  bool explains() const;

  std::vector<Point> points_;
  std::vector<std::uint8_t> hidden_;
  /// By direction: the points that are hidden from it begin in hidden_points_ at first_point_, and
  /// end where the next one's begin.
  std::vector<std::uint32_t> first_point_, hidden_points_;
  /// The left side of the shares' equations, of those columns that were asked for.
  Eigen::MatrixXf squares_;
  std::vector<std::uint8_t> has_column_;
  Eigen::ArrayXf diagonal_, gradient_;
  Eigen::MatrixXf shares_;  ///< directions by channels
  std::vector<float> residuals_;
};

}  // namespace diminish
