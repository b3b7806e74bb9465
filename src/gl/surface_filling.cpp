#include "gl/surface_filling.h"

#include <fmt/format.h>

#include <array>
#include <string>

#include "diminish/diminished_frame.h"
#include "gl/pixels_of.h"
#include "inpaint/surface_rules.h"
#include "membrane/smooth_filling.h"

namespace diminish::gl {
namespace {

/// The memory of a work group on every driver (32 KiB).
constexpr std::size_t coarsest_cells = 1900;
constexpr int tile = 32;
/// Grids halve in size and take two steps each. The last ones are solved in one step.
constexpr int most_steps = 32;

// Locations of fill.glsl's uniforms.
enum Location : GLint {
  stored_rect,
  region_rect,
  window_rect,
  fine_rect,
  coarse_rect,
  fine_at,
  coarse_at,
  is_rest_stage,
  rest_sizes
};

// Places in the work buffer: the flags, and where the dispatches begin.
constexpr std::size_t flags_bytes = 16;
constexpr std::size_t dispatch_bytes = 12;

std::string factors(const SmoothFilling::Relaxation& relaxation) {
  std::string list;
  for (int k = 0; k < relaxation.half_sweeps; ++k) {
    list += fmt::format("{}{:.9f}", k > 0 ? ", " : "", relaxation.factor(k));
  }
  return "float[](" + list + ")";
}

std::string rules() {
  return fmt::format(
      "#define LABELS {}u\n#define PLANES {}\n#define FIRST_PLANE {}u\n#define INPAINTED {}u\n"
      "#define UNKNOWN {}u\n#define CELL {}\n#define STEP {}\n#define GAP {}\n#define REACH {}\n"
      "#define FEWEST {}u\n#define SHADOW {:.9f}\n#define RIM_PERCENT {}u\n"
      "#define COARSEST_CELLS {}\n#define REST_PASSES {}\n#define COARSE_HALF_SWEEPS {}\n"
      "const float COARSE_FACTORS[] = {};\n",
      surface_rules::labels, PlaneColors::planes, surface_label::first_plane, provenance::inpainted,
      provenance::unknown, PlaneColors::cell, PlaneColors::step, PlaneColors::gap,
      PlaneColors::reach, PlaneColors::fewest, surface_rules::shadow,
      surface_rules::plane_rim_percent, coarsest_cells, most_steps,
      SmoothFilling::coarser.half_sweeps, factors(SmoothFilling::coarser));
}

Program filling_pass(std::vector<std::string> files, const std::string& defines = {}) {
  files.insert(files.begin(), "fill.glsl");
  return compute_program(std::move(files), rules() + defines);
}

Program refining(const SmoothFilling::Relaxation& relaxation, const char* defines) {
  return filling_pass({"fill_layers.glsl", "fill_refine.comp"},
                      fmt::format("{}#define HALF_SWEEPS {}\nconst float FACTORS[] = {};\n",
                                  defines, relaxation.half_sweeps, factors(relaxation)));
}

Rect coarser(const Rect& rect) {
  const int x = rect.x >> 1;
  const int y = rect.y >> 1;
  return {x, y, ((rect.right() + 1) >> 1) - x, ((rect.bottom() + 1) >> 1) - y};
}

void set(GLint location, const Rect& rect) {
  glUniform4i(location, rect.x, rect.y, rect.width, rect.height);
}

GLuint groups(int cells, int group) {
  return static_cast<GLuint>((cells + group - 1) / group);
}

void barrier() {
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
}

Rect filling_cells(const Rect& region) {
  constexpr int cell = PlaneColors::cell;
  return {0, 0, (region.width + cell - 1) / cell, (region.height + cell - 1) / cell};
}

}  // namespace

SurfaceFilling::SurfaceFilling()
    : states_(filling_pass({"fill_states.comp"})),
      plane_colors_(filling_pass({"fill_plane_colors.comp"})),
      unite_(filling_pass({"fill_parts.glsl", "fill_unite.comp"})),
      rims_(filling_pass({"fill_parts.glsl", "fill_rims.comp"})),
      gather_(filling_pass({"fill_gather.comp"})),
      coarsen_(filling_pass({"fill_layers.glsl", "fill_coarsen.comp"})),
      coarsest_(filling_pass({"fill_layers.glsl", "fill_coarsest.comp"})),
      refine_(refining(SmoothFilling::coarser, "")),
      finest_(refining(SmoothFilling::finest, "#define FINEST\n")) {
  work_.reserve(flags_bytes + most_steps * dispatch_bytes);
}

/// Lays out the grids: the window's pixels, and smaller ones until the rest fits into a work
/// group's memory. Then the steps: down to the coarsest grid and up again.
void SurfaceFilling::lay_out(const Rect& window) {
  const auto fit = [](Rect rect) {
    std::size_t cells = pixels_of(rect);
    while (pixels_of(rect) > 1) {
      rect = coarser(rect);
      cells += pixels_of(rect);
    }
    return cells <= coarsest_cells;
  };
  grids_.assign(1, {window, 0});
  std::size_t cells = 0;
  do {
    const Rect rect = coarser(grids_.back().rect);
    grids_.push_back({rect, static_cast<int>(cells)});
    cells += pixels_of(rect) * surface_rules::labels;
  } while (grids_.size() < 3 || !fit(grids_.back().rect));
  cells_.reserve(sizeof(GLuint) * cells);

  steps_.clear();
  const auto add = [&](const Program& program, std::size_t fine, std::size_t over, int group,
                       bool by_label) {
    const Rect& rect = grids_[over].rect;
    steps_.push_back({&program, fine, fine + 1, groups(rect.width, group),
                      groups(rect.height, group), by_label});
  };
  const std::size_t last = grids_.size() - 1;
  add(gather_, 0, 1, 8, false);
  for (std::size_t l = 1; l + 1 < last; ++l) add(coarsen_, l, l + 1, 8, true);
  steps_.push_back({&coarsest_, last - 1, last, 1, 1, true});
  for (std::size_t l = last - 1; l > 0; --l) add(refine_, l, l, tile, true);
  add(finest_, 0, 0, tile, false);
}

void SurfaceFilling::fill(const Buffers& buffers, const Rect& stored, const Rect& region,
                          const Rect& window, PassTimer& timer) {
  if (window.empty()) return;
  lay_out(window);
  const Rect cells = filling_cells(region);
  pixels_.reserve(sizeof(GLuint) * pixels_of(window));
  parts_.reserve(3 * sizeof(GLuint) * pixels_of(window));
  plane_sums_.reserve(2 * sizeof(GLuint) * PlaneColors::planes * (pixels_of(cells) + 1));
  const Buffer* const bound[] = {&buffers.picture, &buffers.provenance, &buffers.surface, &pixels_,
                                 &parts_,          &plane_sums_,        &cells_,          &work_};
  for (GLuint i = 0; i < std::size(bound); ++i) bound[i]->bind(i);
  for (const Program* program : {&states_, &plane_colors_, &unite_, &rims_, &gather_, &coarsen_,
                                 &coarsest_, &refine_, &finest_}) {
    program->use();
    set(stored_rect, stored);
    set(region_rect, region);
    set(window_rect, window);
  }
  timer.measure("holes", [&] { find_holes(region, window); });
  timer.measure("filling", [&] {
    solve(false);
    solve(true);
  });
}

/// Computes states, plane colours and the holes' borders.
void SurfaceFilling::find_holes(const Rect& region, const Rect& window) const {
  const auto over_window = [&](const Program& program) {
    program.use();
    glDispatchCompute(groups(window.width, 64), static_cast<GLuint>(window.height), 1);
  };
  const Rect cells = filling_cells(region);
  if (!region.empty()) {
    plane_colors_.use();
    glDispatchCompute(groups(cells.width, 16), groups(cells.height, 16), 1);
  }
  for (const Program* program : {&states_, &unite_, &rims_}) {
    over_window(*program);
    barrier();
  }
}

/// Fills what is left after each label has been filled from its own pixels. Only the GPU knows
/// whether there is any.
void SurfaceFilling::solve(bool is_rest) const {
  if (is_rest) glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, work_.name());
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Step& step = steps_[i];
    step.program->use();
    set(fine_rect, grids_[step.fine].rect);
    set(coarse_rect, grids_[step.coarse].rect);
    glUniform1i(fine_at, grids_[step.fine].first);
    glUniform1i(coarse_at, grids_[step.coarse].first);
    glUniform1i(is_rest_stage, is_rest ? 1 : 0);
    if (is_rest) {
      glDispatchComputeIndirect(static_cast<GLintptr>(flags_bytes + i * dispatch_bytes));
    } else {
      if (step.program == &coarsest_) send_rest_sizes();
      glDispatchCompute(step.across, step.down,
                        step.by_label ? static_cast<GLuint>(surface_rules::labels) : 1);
    }
    barrier();
  }
}

void SurfaceFilling::send_rest_sizes() const {
  std::array<GLint, 2 * most_steps> sizes{};
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    sizes[2 * i] = static_cast<GLint>(steps_[i].across);
    sizes[2 * i + 1] = static_cast<GLint>(steps_[i].down);
  }
  glUniform2iv(rest_sizes, most_steps, sizes.data());
}

}  // namespace diminish::gl
