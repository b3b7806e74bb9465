#pragma once

#include <memory>
#include <vector>

#include "diminish/occlusion_masks.h"
#include "diminish/tiled_region.h"
#include "memory/keyframe.h"

namespace diminish {

/// The keyframes, oldest first: some, and no more than a budget of memory allows.
class KeyframeStore {
 public:
  static constexpr std::size_t most_keyframes = 16;
  static constexpr std::size_t most_bytes = std::size_t{256} << 20;

  KeyframeStore(const Intrinsics& color, const KeyframeGrid& grid);

  bool empty() const { return keyframes_.empty(); }
  std::size_t size() const { return keyframes_.size(); }
  std::size_t bytes() const;
  const Keyframe& newest() const { return *keyframes_.back(); }

  /// If there are too many, the one goes that shows least of what the others do not.
  void add(Keyframe keyframe);
  void drop_older_than(double stamp_s);
  void clear() { keyframes_.clear(); }

  /// Those that together show most of the objects' mask, the best first. Nearer ones are better:
  /// errors in depth show less.
  std::vector<std::shared_ptr<const Keyframe>> choose(std::size_t most, const Mask& objects,
                                                      const TiledRegion& region,
                                                      const RigidTransform& color_from_world) const;

  /// Removes points from all keyframes. points_m: in the frame of one of them, whose pose is given.
  void remove(const std::vector<Eigen::Vector3f>& points_m, const RigidTransform& color_from_world);

 private:
  std::size_t count_unique(std::size_t index) const;

  KeyframeGrid grid_;
  Projection color_, lens_;  ///< of the picture, of the grid
  std::vector<std::shared_ptr<Keyframe>> keyframes_;
};

}  // namespace diminish
