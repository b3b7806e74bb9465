#include "detect/articulated/kinematic_chain.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/text.h"
#include "source/configuration_checks.h"

namespace diminish {
namespace {

int find_parent(const std::vector<KinematicChain::Link>& links, const Config& place) {
  const std::string name = place.text();
  std::vector<std::string> known;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i].name == name) return static_cast<int>(i);
    known.push_back(links[i].name);
  }
  if (known.empty()) place.fail("expected an earlier link, and this is the first");
  place.fail("expected one of the earlier links " + join(known) + ", got '" + printable(name) +
             "'");
}

KinematicChain::Joint read_joint(const Config& place) {
  const std::string name = place.text();
  if (name == "revolute") return KinematicChain::Joint::revolute;
  if (name == "prismatic") return KinematicChain::Joint::prismatic;
  if (name == "fixed") return KinematicChain::Joint::fixed;
  place.fail("expected revolute, prismatic or fixed, got '" + printable(name) + "'");
}

KinematicChain::Link read_link(const Config& config,
                               const std::vector<KinematicChain::Link>& earlier) {
  config.expect_keys({"name", "mesh", "parent", "origin", "rotation", "axis", "joint"});
  KinematicChain::Link link;
  link.name = config.at("name").text();
  link.mesh = config.at("mesh").path();
  if (const Config parent = config.find("parent"); parent.exists()) {
    link.parent = find_parent(earlier, parent);
  }
  RigidTransform& at = link.parent_from_joint;
  if (const Config origin = config.find("origin"); origin.exists()) {
    at.translation = origin.vector3();
  }
  if (const Config rotation = config.find("rotation"); rotation.exists()) {
    const std::vector<double> numbers = rotation.numbers(9);
    at.rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
  }
  check_rigid_transform(at, config);
  if (const Config axis = config.find("axis"); axis.exists()) {
    link.axis = axis.vector3();
    if (!(link.axis.norm() > 1e-6)) axis.fail("expected a direction, got a vector without length");
    link.axis.normalize();
    link.joint = KinematicChain::Joint::revolute;
  }
  if (const Config joint = config.find("joint"); joint.exists()) {
    link.joint = read_joint(joint);
    if (link.joint != KinematicChain::Joint::fixed) config.at("axis");
  }
  return link;
}

}  // namespace

KinematicChain KinematicChain::load(const std::filesystem::path& file) {
  return read(Config::load(file));
}

KinematicChain KinematicChain::read(const Config& config) {
  config.expect_keys({"links"});
  KinematicChain chain;
  for (const Config& item : config.at("links").items()) {
    Link link = read_link(item, chain.links_);
    const bool is_known = std::any_of(chain.links_.begin(), chain.links_.end(),
                                      [&](const Link& other) { return other.name == link.name; });
    if (is_known) {
      item.at("name").fail("there are two links called '" + printable(link.name) + "'");
    }
    chain.links_.push_back(std::move(link));
  }
  if (chain.links_.empty()) config.at("links").fail("expected at least one link");
  return chain;
}

std::size_t KinematicChain::joint_count() const {
  return static_cast<std::size_t>(std::count_if(
      links_.begin(), links_.end(), [](const Link& link) { return link.joint != Joint::fixed; }));
}

void KinematicChain::move(const std::vector<double>& positions,
                          std::vector<RigidTransform>& base_from_link) const {
  base_from_link.resize(links_.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    RigidTransform moved;
    if (link.joint == Joint::revolute) {
      moved.rotation = Eigen::AngleAxisd(positions[next++], link.axis).toRotationMatrix();
    } else if (link.joint == Joint::prismatic) {
      moved.translation = positions[next++] * link.axis;
    }
    base_from_link[i] = link.parent_from_joint * moved;
    if (link.parent >= 0) {
      base_from_link[i] = base_from_link[static_cast<std::size_t>(link.parent)] * base_from_link[i];
    }
  }
}

}  // namespace diminish
