#pragma once

#include <memory>
#include <vector>

#include "diminish/occlusion_masks.h"
#include "diminish/tiled_region.h"
#include "memory/keyframe.h"
#include "memory/keyframe_preparation.h"

namespace diminish {

/// The keyframes, oldest first: some, and no more than a budget of memory allows.
class KeyframeStore {
 public:
  static constexpr std::size_t most_keyframes = 16;
  static constexpr std::size_t most_bytes = std::size_t{256} << 20;

  KeyframeStore(const Rig& rig, const KeyframeGrid& grid);

  bool empty() const { return keyframes_.empty(); }
  std::size_t size() const { return keyframes_.size(); }
  std::size_t bytes() const;
  const Keyframe& newest() const { return *keyframes_.back(); }
  const std::vector<std::shared_ptr<Keyframe>>& all() const { return keyframes_; }

  /// A keyframe to fill and to add: one that went and that nobody looks at any more, so that its
  /// memory is used again.
  std::shared_ptr<Keyframe> take();
  /// If there are too many, the one goes that shows least of what the others do not.
  void add(std::shared_ptr<Keyframe> keyframe);
  /// Forgets places that neither the user nor an RGB-D camera has seen since, and keyframes of
  /// which none is left. The background stays.
  void forget_before(double stamp_s);
  /// An RGB-D camera saw some of a keyframe's places unchanged. confirmed: by place.
  void refresh(const Keyframe& keyframe, const Mask& confirmed, const Rect& part, double stamp_s);
  /// Forgets the keyframes for which it says so. predicate(Keyframe&): bool; called once for each.
  template <class Predicate>
  void forget_if(const Predicate& predicate) {
    std::erase_if(keyframes_, [&](const auto& keyframe) {
      const bool is_gone = predicate(*keyframe);
      if (is_gone) let_go(keyframe);
      return is_gone;
    });
  }
  void clear();

  /// A keyframe, and the part of the picture in which it shows what the objects hide.
  struct Choice {
    std::shared_ptr<const Keyframe> keyframe;
    TiledRegion part;
  };
  /// Those that together show most of the objects' mask, the best first. Nearer ones are better:
  /// errors in depth show less. Returns how many; `chosen` may hold more. Cost: 10 us a keyframe,
  /// and reading the mask.
  std::size_t choose(std::size_t most, const Mask& objects, const TiledRegion& region,
                     const RigidTransform& color_from_world, std::vector<Choice>& chosen);

  /// Removes points from all keyframes. points_m: in the frame of one of them, whose pose is given.
  void remove(const std::vector<Eigen::Vector3f>& points_m, const RigidTransform& color_from_world);

 private:
  /// Around the cells with objects that a keyframe shows.
  void find_part(const std::vector<std::uint8_t>& shown, const Rect& region,
                 TiledRegion& part) const;
  void let_go(std::shared_ptr<Keyframe> keyframe);
  std::size_t count_unique(std::size_t index) const;
  /// Which cells of the region a keyframe shows.
  void find_shown(const Keyframe& keyframe, const RigidTransform& color_from_keyframe,
                  const Rect& region, std::vector<std::uint8_t>& shown) const;

  KeyframeGrid grid_;
  KeyframePreparation preparation_;
  Projection color_;  ///< of the picture
  int picture_width_;
  std::vector<std::shared_ptr<Keyframe>> keyframes_;
  /// That went. A few: others may still draw them.
  std::vector<std::shared_ptr<Keyframe>> gone_;
  // By cell of the region: pixels of the objects; those that no chosen keyframe shows; what each
  // shows.
  std::vector<int> hidden_, wanted_;
  std::vector<std::vector<std::uint8_t>> shown_;
  std::vector<double> weights_;
};

}  // namespace diminish
