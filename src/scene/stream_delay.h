#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/turns.h"
#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"
#include "diminish/scene_samples.h"
#include "geometry/point_projection.h"

namespace diminish {

/// Whether an RGB-D camera's images are older than they say, from whatever moves in the scene.
/// Where the user's picture has changed, it is compared with what the RGB-D camera shows there: as
/// it is now, and as it was a few frames ago. A good camera shows what the picture shows now, a
/// late one what it showed then. Several pipelines share what they know, each with a frame of the
/// same sequence.
class StreamDelay {
 public:
  explicit StreamDelay(const Intrinsics& color);

  void share(StreamDelay& other) { shared_ = other.shared_; }
  void take_turn() { turn_.take(shared_->turns); }
  /// Does nothing if there is none.
  void end_turn() { turn_.end(); }

  struct Inputs {
    ImageView<Bgr> picture;  ///< the user's
    double stamp_s;
    const RigidTransform& color_from_world;
    const Mask& occlusion;  ///< objects to remove
    const SceneSamples& samples;
  };
  /// late_s: for each RGB-D camera by how much its images are late, to about 0.06 s; nothing where
  /// they are not, or too little moves. Waits for its turn and ends it. Cost: 0.1 us a sample, and
  /// what it takes to make a picture smaller.
  void find(const Inputs& inputs, std::vector<std::optional<double>>& late_s);

 private:
  /// Of about 1/30 s each.
  static constexpr std::size_t bins = 10;

  struct Moment {
    double stamp_s = 0;
    RigidTransform color_from_world;
    Image<std::uint8_t> grey;  ///< made smaller; 0 on an object
  };
  /// How far what an RGB-D camera shows is from what the user's picture shows, by how long ago.
  struct Errors {
    std::array<double, bins> levels{}, count{};
  };
  struct Shared {
    Turns turns;
    std::vector<Moment> moments;             ///< the newest last
    std::vector<Image<std::uint8_t>> spare;  ///< of forgotten ones: their memory serves again
    std::vector<Errors> errors;              ///< of each RGB-D camera
  };
  /// An earlier moment that this frame's samples are compared with.
  struct Then {
    const Image<std::uint8_t>* grey;
    FloatTransform from_now;
    std::size_t bin;
  };
  static constexpr std::size_t most_moments = 5;
  /// A sample of a place where the user's picture has changed.
  struct Changed {
    float level;
    std::array<int, most_moments> then;
  };
  void remember(const Inputs& inputs, std::size_t cameras);
  void forget_oldest();
  void choose_moments(const Inputs& inputs);
  void compare(const Inputs& inputs, std::size_t begin, std::size_t end, Errors& errors);
  /// share: what an earlier moment's error must be of that now, at most.
  static std::optional<double> delay_of(const Errors& errors, double share);

  Projection projection_;  ///< of the user's camera
  int shrinkage_;
  std::vector<Then> chosen_;
  std::vector<Changed> changed_;
  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  Turn turn_;
};

}  // namespace diminish
