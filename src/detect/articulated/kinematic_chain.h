#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "diminish/config.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// Rigid links, joined one to another from the base up: what a URDF's links and joints say.
class KinematicChain {
 public:
  enum class Joint { fixed, revolute, prismatic };
  struct Link {
    std::string name;
    std::filesystem::path mesh;  ///< a Wavefront OBJ file, in the link's frame
    int parent = -1;             ///< an earlier link; -1: it is joined to the base's frame
    RigidTransform parent_from_joint;
    Joint joint = Joint::fixed;
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< of length 1, in the joint's frame
  };

  /// Reads the file: `links`, each with `name` and `mesh`, and where it is joined to another:
  /// `parent` (an earlier link), `origin` (metres), `rotation` (9 numbers), `axis`, `joint`
  /// (revolute, prismatic). Throws Error that names file and key.
  static KinematicChain load(const std::filesystem::path& file);
  static KinematicChain read(const Config& config);

  const std::vector<Link>& links() const { return links_; }
  /// How many joints move.
  std::size_t joint_count() const;
  /// positions: of the joints that move, in the links' order, radians or metres. base_from_link:
  /// gets one transform for each link.
  void move(const std::vector<double>& positions,
            std::vector<RigidTransform>& base_from_link) const;

 private:
  std::vector<Link> links_;
};

}  // namespace diminish
