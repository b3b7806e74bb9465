#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace diminish {

/// Finds how much of a plane's light comes from where, using the shadows on it.
///
/// The plane's brightness is a smooth field, quadratic in its coordinates, times the light that is
/// left, and that is
///
///   light(p) = 1 - sum over directions d of  share_d hidden_d(p)
///
/// where hidden_d(p) is 1 if something stands between p and the light from d. Field and shares,
/// none of them negative, follow from the brightness by robust alternating least squares (Sato,
/// Sato & Ikeuchi 2003, "Illumination from shadows").
class ShadowFit {
 public:
  /// There is always some ambient light.
  static constexpr float least_light = 0.15F;

  /// Starts a fit without points.
  void begin(std::size_t directions);
  /// Adds a point. place: on the plane. levels: its colour. hidden: the directions in which
  /// something hides the light.
  void add(const Eigen::Vector2f& place, const Eigen::Array3f& levels,
           const std::vector<std::uint8_t>& hidden);
  std::size_t size() const { return points_.size(); }

  /// Fits, and returns whether shadows explain the brightness: much better than no shadows, with no
  /// more loss of light than objects on a plane can cause, and about the same loss in each channel.
  /// Cost: about 1 us per point.
  bool fit();
  /// The share of one direction's light, by channel. Call after fit().
  Eigen::Array3f share(std::size_t direction) const;

 private:
  static constexpr int brightness = 3;  ///< a fourth channel: the mean of all
  /// x^a y^b of a place (x, y), up to a + b = 4. Those up to 2, which the field uses, come first.
  using Monomials = Eigen::Array<float, 16, 1>;
  struct Point {
    Monomials monomials;
    Eigen::Array4f levels;
    Eigen::Array3f relative;                  ///< to the field, by channel
    std::uint32_t first_hidden, last_hidden;  ///< in hidden_
    float weight, light, field;
  };

  void sort_by_direction();
  void fit_field(int channel);
  void weigh(float end_in_shadow);
  void fit_shares(int channel);
  const float* column(std::size_t direction);
  void find_light();
  bool explains();
  bool is_colorless() const;

  std::vector<Point> points_;
  std::vector<std::uint8_t> hidden_;
  /// By direction: its hidden points begin in hidden_points_ at first_point_ and end where the next
  /// direction's begin.
  std::vector<std::uint32_t> first_point_, hidden_points_;
  /// The left side of the equations for the shares; only the columns that were needed.
  Eigen::MatrixXf squares_;
  std::vector<std::uint8_t> has_column_;
  Eigen::ArrayXf diagonal_, gradient_;
  std::vector<float> weights_, darker_;  ///< of each point, and times how much darker it is
  Eigen::MatrixXf shares_;               ///< directions by channels
  std::vector<float> residuals_;
  float unexplained_ = 1;  ///< share of the squared error in the shadow
};

}  // namespace diminish
