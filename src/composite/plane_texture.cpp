#include "composite/plane_texture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/channels.h"
#include "core/runs.h"
#include "geometry/point_projection.h"

namespace diminish {
namespace {

/// A brick's side in the picture, about. It must hold a few ripples of a grain, and the example
/// must have places that large.
constexpr float brick_px = 36;
/// How far from the objects the example is looked for.
constexpr int example_reach_px = 96;
/// Fewer invented pixels are left smooth.
constexpr int fewest_pixels = 200;
/// Every fourth pixel tells which bricks are wanted.
constexpr int look_step = 4;
/// A plane seen so flatly that it has more bricks is left smooth.
constexpr int most_bricks = 1 << 12;
/// Places of the example: the luckiest. Nobody sees that a grain comes back so often.
constexpr std::size_t most_blocks = 12;
/// A place whose pixels are so much smaller or larger on the plane shows another grain.
constexpr float most_scale = 2.5F;
/// Levels: a place whose mean differs so much from the brick's colour shows something else. It is
/// not weighed against luck: then noise would change a brick's grain from frame to frame.
constexpr float most_away = 24;
/// Of the grain: half of its energy. A grain in the wrong place is an error, too.
constexpr float strength = 0.7F;
/// Along so many pixels of a row, places on the plane lie evenly.
constexpr int segment = 16;
/// For differences of places on the plane, bricks.
constexpr float step = 0.5F;
constexpr int rows_at_once = 32;

std::uint32_t scramble(std::uint32_t value) {
  value = (value ^ (value >> 16)) * 0x7feb352dU;
  value = (value ^ (value >> 15)) * 0x846ca68bU;
  return value ^ (value >> 16);
}
/// From 0 to 1, as good as random, the same wherever it is asked.
float luck_of(int i, int j, int k = 0, int l = 0) {
  std::uint32_t value = 0;
  for (const int key : {i, j, k, l}) {
    value = scramble(value * 0x9e3779b9U + static_cast<std::uint32_t>(key) + 1);
  }
  return static_cast<float>(value) / static_cast<float>(std::numeric_limits<std::uint32_t>::max());
}

/// Every other row of bricks is moved back by half a brick.
float row_shift(int j) {
  return j % 2 == 0 ? 0 : 0.5F;
}

/// Without SSE4, std::floor is a call.
int floor_of(float value) {
  const auto whole = static_cast<int>(value);
  return whole - (static_cast<float>(whole) > value ? 1 : 0);
}

}  // namespace

void PlaneTexture::find(const Inputs& inputs, const DiminishedFrame& result) {
  found_ = 0;
  if (result.surfaces.label.empty()) return;
  part_ = intersect(inputs.objects, result.surfaces.region);
  for (std::size_t k = 0; k < inputs.planes.size(); ++k) {
    if (grains_.size() <= found_) grains_.emplace_back();
    Grain& grain = grains_[found_];
    grain.label = static_cast<std::uint8_t>(surface_label::first_plane + k);
    if (find_grain(inputs, inputs.planes[k], result, grain)) ++found_;
  }
}

void PlaneTexture::add(const Inputs& inputs, DiminishedFrame& result) {
  for (std::size_t k = 0; k < found_; ++k) {
    Grain& grain = grains_[k];
    for (const Brick& brick : grain.bricks) make_tile(brick, result.picture, grain);
    grain.example.find_grain(inputs.camera);
    for_row_groups(part_.height, rows_at_once, [&](Rows rows) { add_rows(grain, rows, result); });
  }
}

/// False if nothing of the plane is invented, or its grain cannot be had.
bool PlaneTexture::find_grain(const Inputs& inputs, const BackgroundPlane& plane,
                              const DiminishedFrame& result, Grain& grain) const {
  const std::optional<float> depth_m = mean_depth_m(result, plane, grain.label);
  if (!depth_m) return false;
  // In steps of half an octave: from frame to frame it stays the same.
  const float wanted_m = brick_px * *depth_m / lens_.fx;
  grain.axes = axes_of(inputs, plane, std::exp2(std::round(2 * std::log2(wanted_m)) / 2));
  grain.example.find(inputs.camera, inputs.occlusion, grow(part_, example_reach_px), inputs.samples,
                     plane);
  find_blocks(grain);
  return !grain.blocks.empty() && lay_bricks(result, grain);
}

/// Calls visit(x, y) for every fourth pixel of every fourth row that was invented on a plane.
template <class Visit>
void PlaneTexture::for_some_open(const DiminishedFrame& result, std::uint8_t label,
                                 const Visit& visit) const {
  for (int y = part_.y; y < part_.bottom(); y += look_step) {
    for (int x = part_.x; x < part_.right(); x += look_step) {
      const bool is_invented = result.provenance(x, y) == provenance::inpainted;
      if (is_invented && result.surfaces.label(x, y) == label) visit(x, y);
    }
  }
}

/// Of what is invented on a plane; nothing if that is little.
std::optional<float> PlaneTexture::mean_depth_m(const DiminishedFrame& result,
                                                const BackgroundPlane& plane,
                                                std::uint8_t label) const {
  int count = 0;
  float sum_m = 0;
  for_some_open(result, label, [&](int x, int y) {
    const Eigen::Vector2f ray = (*rays_)(x, y);
    const float inverse = plane.inverse_depth(ray.x(), ray.y());
    if (!(inverse > 0)) return;
    sum_m += 1 / inverse;
    ++count;
  });
  if (count * look_step * look_step < fewest_pixels) return std::nullopt;
  return sum_m / static_cast<float>(count);
}

/// From the world's origin along one of its axes, so that they stay where they are.
PlaneTexture::Axes PlaneTexture::axes_of(const Inputs& inputs, const BackgroundPlane& plane,
                                         float size_m) {
  const RigidTransform world = inputs.color_from_world.value_or(RigidTransform{});
  const Eigen::Vector3f origin = world.translation.cast<float>();
  const Eigen::Matrix3f turn = world.rotation.cast<float>();
  Eigen::Index axis = 0;
  (turn.transpose() * plane.normal).cwiseAbs().minCoeff(&axis);
  const Eigen::Vector3f along = turn.col(axis);
  Axes axes{plane, origin - plane.height_m(origin) * plane.normal, {}, {}, size_m};
  axes.u = (along - plane.normal.dot(along) * plane.normal).normalized();
  axes.v = plane.normal.cross(axes.u);
  return axes;
}

/// What of the plane is seen at a pixel.
std::optional<Eigen::Vector2f> PlaneTexture::coordinates(const Axes& axes, int x, int y) const {
  constexpr float farthest = 1e6F;
  const Eigen::Vector2f ray = (*rays_)(x, y);
  const float inverse = axes.plane.inverse_depth(ray.x(), ray.y());
  if (!(inverse > 0)) return std::nullopt;
  const Eigen::Vector3f from_origin = Eigen::Vector3f(ray.x(), ray.y(), 1) / inverse - axes.origin;
  const Eigen::Vector2f at =
      Eigen::Vector2f(from_origin.dot(axes.u), from_origin.dot(axes.v)) / axes.size_m;
  if (!(at.cwiseAbs().maxCoeff() < farthest)) return std::nullopt;
  return at;
}

/// Where it is in the picture.
std::optional<Eigen::Vector2f> PlaneTexture::place(const Axes& axes, float a, float b) const {
  return project_exactly(lens_, axes.origin + axes.size_m * (a * axes.u + b * axes.v));
}

/// Also how far a brick's sides along u and v reach there.
std::optional<Eigen::Vector2f> PlaneTexture::place(const Axes& axes, float a, float b,
                                                   Eigen::Matrix2f& sides) const {
  auto middle = place(axes, a, b);
  const auto right = place(axes, a + step, b);
  const auto up = place(axes, a, b + step);
  if (!middle || !right || !up) return std::nullopt;
  sides << *right - *middle, *up - *middle;
  sides /= step;
  return middle;
}

PlaneTexture::Brick PlaneTexture::brick_at(const Eigen::Vector2f& at) {
  const int j = floor_of(at.y());
  return {floor_of(at.x() + row_shift(j)), j};
}

/// Finds the bricks of what is invented. False if there are too many.
bool PlaneTexture::lay_bricks(const DiminishedFrame& result, Grain& grain) const {
  std::vector<Brick>& bricks = grain.bricks;
  Image<Tile>& tiles = grain.tiles;
  Brick& begin = grain.first;
  bricks.clear();
  for_some_open(result, grain.label, [&](int x, int y) {
    if (const auto at = coordinates(grain.axes, x, y)) bricks.push_back(brick_at(*at));
  });
  if (bricks.empty()) return false;
  Brick last = begin = bricks.front();
  for (const Brick& brick : bricks) {
    begin = {std::min(begin.i, brick.i), std::min(begin.j, brick.j)};
    last = {std::max(last.i, brick.i), std::max(last.j, brick.j)};
  }
  const int columns = last.i - begin.i + 1;
  const int rows = last.j - begin.j + 1;
  if (columns > most_bricks || rows > most_bricks || columns * rows > most_bricks) return false;
  tiles.resize(columns, rows);
  tiles.fill(tiles.bounds(), Tile{});
  std::erase_if(bricks, [&](const Brick& brick) {
    return std::exchange(tiles(brick.i - begin.i, brick.j - begin.j).is_wanted, true);
  });
  return true;
}

/// Places whose surroundings, as large as a brick, are nearly all in the example.
void PlaneTexture::find_blocks(Grain& grain) const {
  const Axes& axes = grain.axes;
  std::vector<Block>& blocks = grain.blocks;
  blocks.clear();
  constexpr int cell = TextureExample::cell;
  const Rect part = grain.example.part();
  Eigen::Vector2f least = Eigen::Vector2f::Constant(std::numeric_limits<float>::max());
  Eigen::Vector2f most = -least;
  for (int y = part.y + cell / 2; y < part.bottom(); y += cell) {
    for (int x = part.x + cell / 2; x < part.right(); x += cell) {
      if (!grain.example.shows_plane(x, y)) continue;
      const auto at = coordinates(axes, x, y);
      if (!at) continue;
      least = least.cwiseMin(*at);
      most = most.cwiseMax(*at);
    }
  }
  const Eigen::Vector2f size = most - least;
  if (!(size.minCoeff() >= 0 && (size.x() + 1) * (size.y() + 1) < most_bricks)) return;
  for (auto j = static_cast<int>(std::ceil(least.y())); static_cast<float>(j) <= most.y(); ++j) {
    for (auto i = static_cast<int>(std::ceil(least.x())); static_cast<float>(i) <= most.x(); ++i) {
      add_block(i, j, grain);
    }
  }
  if (blocks.size() <= most_blocks) return;
  std::nth_element(blocks.begin(), blocks.begin() + most_blocks, blocks.end(),
                   [](const Block& a, const Block& b) { return a.luck > b.luck; });
  blocks.resize(most_blocks);
}

void PlaneTexture::add_block(int i, int j, Grain& grain) const {
  const Axes& axes = grain.axes;
  constexpr int fewest_shown = 8;  // of 3 x 3 places
  const auto a = static_cast<float>(i);
  const auto b = static_cast<float>(j);
  int shown = 0;
  Eigen::Array3f sum = Eigen::Array3f::Zero();
  for (const float db : {-0.5F, 0.F, 0.5F}) {
    for (const float da : {-0.5F, 0.F, 0.5F}) {
      const auto looked = place(axes, a + da, b + db);
      if (!looked) return;
      const Pixel pixel = nearest_pixel(*looked);
      if (!grain.example.shows_plane(pixel.x, pixel.y)) continue;
      sum += grain.example.mean(pixel.x, pixel.y);
      ++shown;
    }
  }
  Eigen::Matrix2f sides;
  if (shown < fewest_shown || !place(axes, a, b, sides)) return;
  grain.blocks.push_back(
      {i, j, luck_of(i, j), sum / static_cast<float>(shown), std::abs(sides.determinant())});
}

/// The luckiest of those that look like the brick; null: none does.
const PlaneTexture::Block* PlaneTexture::choose(const Grain& grain, Brick brick,
                                                const Eigen::Array3f& color, float area_px) {
  const Block* best = nullptr;
  float best_luck = -1;
  for (const Block& block : grain.blocks) {
    if (block.area_px > most_scale * area_px || block.area_px * most_scale < area_px) continue;
    if ((block.mean - color).abs().maxCoeff() > most_away) continue;
    const float luck = luck_of(brick.i, brick.j, block.i, block.j);
    if (luck <= best_luck) continue;
    best = &block;
    best_luck = luck;
  }
  return best;
}

void PlaneTexture::make_tile(Brick brick, const Image<Bgr>& picture, Grain& grain) const {
  const Axes& axes = grain.axes;
  const float a = static_cast<float>(brick.i) + 0.5F - row_shift(brick.j);
  const float b = static_cast<float>(brick.j) + 0.5F;
  Eigen::Matrix2f sides;
  const auto middle = place(axes, a, b, sides);
  if (!middle) return;
  const float area_px = std::abs(sides.determinant());
  if (!(area_px >= 1)) return;
  const Pixel pixel = nearest_pixel(*middle);
  const Bgr& color = picture(std::clamp(pixel.x, part_.x, part_.right() - 1),
                             std::clamp(pixel.y, part_.y, part_.bottom() - 1));
  const Block* const block = choose(grain, brick, to_channels(color), area_px);
  if (block == nullptr) return;
  Eigen::Matrix2f shown_sides;
  const auto shown =
      place(axes, static_cast<float>(block->i), static_cast<float>(block->j), shown_sides);
  if (!shown) return;
  const Rect part = grain.example.part();
  Tile& tile = grain.tiles(brick.i - grain.first.i, brick.j - grain.first.j);
  tile.has_block = true;
  tile.turn = shown_sides * sides.inverse();
  tile.shift = *shown - tile.turn * *middle -
               Eigen::Vector2f(static_cast<float>(part.x), static_cast<float>(part.y));
  // A pixel more for what is cut off.
  const Eigen::Vector2f reach =
      shown_sides.cwiseAbs().rowwise().sum() / 2 + Eigen::Vector2f::Ones();
  const Pixel corner = nearest_pixel(*shown - reach);
  const Pixel end = nearest_pixel(*shown + reach);
  grain.example.want_grain({corner.x, corner.y, end.x - corner.x + 1, end.y - corner.y + 1});
}

/// Rows of the part.
void PlaneTexture::add_rows(const Grain& grain, Rows rows, DiminishedFrame& result) const {
  for (int y = part_.y + rows.first; y < part_.y + rows.last; ++y) {
    const std::uint8_t* const origin = result.provenance.row(y);
    const std::uint8_t* const labels = result.surfaces.label.row(y);
    for_each_run(origin, part_.x, part_.right(), provenance::inpainted, [&](int first, int last) {
      for_each_run(labels, first, last, grain.label, [&](int begin, int end) {
        add_run(grain, begin, end, y, result.picture.row(y));
      });
    });
  }
}

/// Columns [first, last).
void PlaneTexture::add_run(const Grain& grain, int first, int last, int y, Bgr* colors) const {
  for (int begin = first; begin < last; begin += segment) {
    const int end = std::min(last, begin + segment);
    const auto from = coordinates(grain.axes, begin, y);
    const auto to = coordinates(grain.axes, end - 1, y);
    if (!from || !to) continue;
    const Eigen::Vector2f right = (*to - *from) / static_cast<float>(std::max(1, end - 1 - begin));
    const auto brick_of = [&](int x) {
      return brick_at(*from + static_cast<float>(x - begin) * right);
    };
    // Nearly always one brick or two, each of consecutive pixels.
    const Brick last_brick = brick_of(end - 1);
    for (int x = begin; x < end;) {
      const Brick brick = brick_of(x);
      int next = brick == last_brick ? end : x + 1;
      while (next < end && brick_of(next) == brick) ++next;
      const int column = brick.i - grain.first.i;
      const int row = brick.j - grain.first.j;
      if (grain.tiles.bounds().contains(column, row)) {
        add_tile(grain, grain.tiles(column, row), x, next, y, colors);
      }
      x = next;
    }
  }
}

/// Columns [first, last), which a tile covers.
void PlaneTexture::add_tile(const Grain& grain, const Tile& tile, int first, int last, int y,
                            Bgr* colors) {
  if (!tile.has_block) return;
  constexpr float scale = strength / TextureExample::unit;
  const Eigen::Vector2f right = tile.turn.col(0);
  const Eigen::Vector2f start = static_cast<float>(y) * tile.turn.col(1) + tile.shift;
  for (int x = first; x < last; ++x) {
    const Pixel shown = nearest_pixel(static_cast<float>(x) * right + start);
    const auto level = static_cast<int>(
        std::lrint(scale * static_cast<float>(grain.example.grain(shown.x, shown.y))));
    if (level == 0) continue;
    const auto add = [&](std::uint8_t& channel) {
      channel = static_cast<std::uint8_t>(std::clamp(channel + level, 0, 255));
    };
    add(colors[x].b);
    add(colors[x].g);
    add(colors[x].r);
  }
}

}  // namespace diminish
