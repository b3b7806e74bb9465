#include "scene/shadow_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/channels.h"
#include "core/runs.h"
#include "depth/depth_noise.h"

namespace diminish {
namespace {

constexpr float cell_m = CastShadow::cell_m;
constexpr int grid_cells = CastShadow::grid_cells;
/// Something this near a plane may be the plane.
constexpr float least_height_m = 0.02F;
constexpr std::size_t fewest_lit = 150;
constexpr std::size_t most_lit = 800;
constexpr std::size_t most_blockers = 400;
/// Beams with a smaller share change nothing that is seen.
constexpr float smallest_beam = CastShadow::invisible;

constexpr DepthNoise shadow_noise;

}  // namespace

ShadowSearch::Directions::Directions() {
  constexpr float degree = std::numbers::pi_v<float> / 180;
  Eigen::Index d = 0;
  for (const float elevation : elevations_deg) {
    for (int i = 0; i < azimuths; ++i, ++d) {
      const float azimuth = 360 * degree * static_cast<float>(i) / azimuths;
      along_u[d] = std::cos(azimuth) / std::tan(elevation * degree);
      along_v[d] = std::sin(azimuth) / std::tan(elevation * degree);
    }
  }
}

const ShadowSearch::Directions& ShadowSearch::Directions::all() {
  static const Directions directions;
  return directions;
}

bool ShadowSearch::find(const Inputs& inputs) {
  found_.ground = inputs.ground;
  choose_blockers(inputs);
  choose_lit(inputs);
  if (blockers_.size() < fewest_blockers || lit_.size() < fewest_lit) return false;
  find_hidden();
  if (!fit()) return false;
  keep_beams();
  draw_light();
  return true;
}

/// The points that are on no plane.
void ShadowSearch::choose_blockers(const Inputs& inputs) {
  const CastShadow::Ground& ground = inputs.ground;
  blockers_.clear();
  const std::size_t step = 1 + inputs.object_points_m.size() / most_blockers;
  for (std::size_t i = 0; i < inputs.object_points_m.size(); i += step) {
    const Eigen::Vector3f& point = inputs.object_points_m[i];
    const bool stands_out =
        std::all_of(inputs.planes.begin(), inputs.planes.end(), [&](const auto& plane) {
          return plane.height_m(point) >= least_height_m + shadow_noise.at(point.z());
        });
    if (stands_out) blockers_.push_back({ground.coordinates(point), ground.plane.height_m(point)});
  }
}

/// Uses the camera that sees most of the plane, because two cameras' colours differ.
void ShadowSearch::choose_lit(const Inputs& inputs) {
  const CastShadow::Ground& ground = inputs.ground;
  const std::vector<SceneSample>& samples = inputs.samples;
  const auto is_on = [&](const SceneSample& sample) {
    return std::abs(ground.plane.height_m(sample.point_m)) <=
               2 * shadow_noise.at(sample.point_m.z()) &&
           ground.coordinates(sample.point_m).cwiseAbs().maxCoeff() < cell_m * grid_cells / 2;
  };
  std::array<std::size_t, 256> by_source{};
  on_plane_.clear();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!is_on(samples[i])) continue;
    on_plane_.push_back(static_cast<std::uint32_t>(i));
    ++by_source[samples[i].source];
  }
  const auto most = std::max_element(by_source.begin(), by_source.end());
  const auto source = static_cast<std::uint8_t>(most - by_source.begin());
  const std::size_t step = 1 + *most / most_lit;
  lit_.clear();
  std::size_t count = 0;
  for (const std::uint32_t i : on_plane_) {
    const SceneSample& sample = samples[i];
    if (sample.source != source || count++ % step != 0) continue;
    lit_.push_back({ground.coordinates(sample.point_m), to_channels(sample.color)});
  }
}

template <class Visit>
void ShadowSearch::for_each_direction(const std::uint64_t* bits, const Visit& visit) {
  for (std::size_t word = 0; word < words; ++word) {
    for_each_bit(bits[word],
                 [&](int bit) { visit(bits_a_word * word + static_cast<std::size_t>(bit)); });
  }
}

/// A blocker is as large as a few cells: it darkens the cell that its shadow falls on and those
/// around it.
void ShadowSearch::find_hidden() {
  constexpr int rim = 2;
  constexpr int width = grid_cells + 2 * rim;
  constexpr float last = width - 1;
  struck_.resize(words * width, width, 0);
  const ByDirection along_u = Directions::all().along_u / cell_m;
  const ByDirection along_v = Directions::all().along_v / cell_m;
  for (const Blocker& blocker : blockers_) {
    // Rounds: adds half a cell and truncates.
    const Eigen::Vector2f at =
        CastShadow::to_cells(blocker.place) + Eigen::Vector2f::Constant(rim + 0.5F);
    using Cells = Eigen::Array<int, directions, 1>;
    const Cells x = (at.x() - blocker.height_m * along_u).max(0.F).min(last).cast<int>();
    const Cells y = (at.y() - blocker.height_m * along_v).max(0.F).min(last).cast<int>();
    const Cells place = words * (width * y + x);
    for (std::size_t word = 0, first = 0; first < directions; ++word, first += bits_a_word) {
      std::uint64_t* const struck = struck_.data() + word;
      const std::size_t end = std::min<std::size_t>(first + bits_a_word, directions);
      std::uint64_t bit = 1;
      for (std::size_t d = first; d < end; ++d, bit <<= 1) {
        struck[place[static_cast<Eigen::Index>(d)]] |= bit;
      }
    }
  }
  hidden_.resize(words * grid_cells, grid_cells);
  struck_in_column_.resize(struck_.width(), 1);
  const auto unite = [](const std::uint64_t* a, const std::uint64_t* b, const std::uint64_t* c,
                        int count, std::uint64_t* to) {
    for (int i = 0; i < count; ++i) to[i] = a[i] | b[i] | c[i];
  };
  for (int y = 0; y < grid_cells; ++y) {
    std::uint64_t* const column = struck_in_column_.row(0);
    unite(struck_.row(y + rim - 1), struck_.row(y + rim), struck_.row(y + rim + 1), struck_.width(),
          column);
    const std::uint64_t* const first = column + std::ptrdiff_t{words} * rim;
    unite(first - words, first, first + words, hidden_.width(), hidden_.row(y));
  }
}

bool ShadowSearch::fit() {
  fit_.begin(directions);
  for (const Lit& lit : lit_) {
    const Rect cell = CastShadow::cell_of(lit.place);
    const int x = std::clamp(cell.x, 0, grid_cells - 1);
    const int y = std::clamp(cell.y, 0, grid_cells - 1);
    hidden_from_.clear();
    for_each_direction(&hidden_(words * x, y), [&](std::size_t direction) {
      hidden_from_.push_back(static_cast<std::uint8_t>(direction));
    });
    fit_.add(lit.place, lit.levels, hidden_from_);
  }
  return fit_.fit();
}

void ShadowSearch::keep_beams() {
  const CastShadow::Ground& ground = found_.ground;
  const Directions& light_from = Directions::all();
  float top_m = 0;
  for (const Blocker& blocker : blockers_) top_m = std::max(top_m, blocker.height_m);
  found_.step_m = top_m / 255;
  found_.beam_count_ = 0;
  for (std::size_t d = 0; d < directions; ++d) {
    const Eigen::Array3f share = fit_.share(d);
    if (share.mean() < smallest_beam) continue;
    if (found_.beams_.size() == found_.beam_count_) found_.beams_.emplace_back();
    CastShadow::Beam& beam = found_.beams_[found_.beam_count_++];
    const auto i = static_cast<Eigen::Index>(d);
    const Eigen::Vector2f slope(light_from.along_u[i], light_from.along_v[i]);
    beam.toward = ground.plane.normal + slope.x() * ground.along_u + slope.y() * ground.along_v;
    beam.share = share;
    beam.height.resize(grid_cells, grid_cells, 0);
    for (const Blocker& blocker : blockers_) {
      const auto height = static_cast<std::uint8_t>(blocker.height_m / found_.step_m);
      const Rect struck =
          intersect(grow(CastShadow::cell_of(blocker.place - blocker.height_m * slope), 1),
                    beam.height.bounds());
      for (int y = struck.y; y < struck.bottom(); ++y) {
        for (int x = struck.x; x < struck.right(); ++x) {
          beam.height(x, y) = std::max(beam.height(x, y), height);
        }
      }
    }
  }
}

/// Adds up the hidden light, cell by cell.
void ShadowSearch::draw_light() {
  Image<Eigen::Array3f>& light = found_.light;
  std::array<Eigen::Array4f, directions> shares;
  std::array<std::uint64_t, words> has_share{};
  for (std::size_t d = 0; d < directions; ++d) {
    const Eigen::Array3f share = fit_.share(d);
    shares[d] = {share[0], share[1], share[2], 0};
    if (share.maxCoeff() > 0) {
      has_share[d / bits_a_word] |= std::uint64_t{1} << (d % bits_a_word);
    }
  }
  dark_.resize(grid_cells, grid_cells, Eigen::Array4f::Zero());
  Rect shaded;
  for (int y = 0; y < grid_cells; ++y) {
    const std::uint64_t* hidden = hidden_.row(y);
    int first = grid_cells;
    int last = -1;
    for (int x = 0; x < grid_cells; ++x, hidden += words) {
      const std::array<std::uint64_t, words> bits = {hidden[0] & has_share[0],
                                                     hidden[1] & has_share[1]};
      if ((bits[0] | bits[1]) == 0) continue;
      first = std::min(first, x);
      last = x;
      Eigen::Array4f dark = Eigen::Array4f::Zero();
      for_each_direction(bits.data(), [&](std::size_t direction) { dark += shares[direction]; });
      dark_(x, y) = dark;
    }
    if (last >= 0) shaded = join(shaded, {first, y, last + 1 - first, 1});
  }
  // Lights have a size, so take the mean of three by three cells.
  const Rect part = intersect(grow(shaded, 1), {1, 1, grid_cells - 2, grid_cells - 2});
  light.resize(grid_cells, grid_cells, Eigen::Array3f::Ones());
  for (int y = part.y; y < part.bottom(); ++y) {
    const Eigen::Array4f* const above = dark_.row(y - 1);
    const Eigen::Array4f* const own = dark_.row(y);
    const Eigen::Array4f* const below = dark_.row(y + 1);
    const auto column = [&](int x) { return Eigen::Array4f(above[x] + own[x] + below[x]); };
    Eigen::Array4f left = column(part.x - 1);
    Eigen::Array4f middle = column(part.x);
    for (int x = part.x; x < part.right(); ++x) {
      const Eigen::Array4f right = column(x + 1);
      const Eigen::Array4f left_over =
          (1 - (left + middle + right) / 9).max(ShadowFit::least_light);
      light(x, y) = {left_over[0], left_over[1], left_over[2]};
      left = middle;
      middle = right;
    }
  }
}

}  // namespace diminish
