#include "gl/membrane_solver.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "gl/program.h"

namespace diminish::gl {
namespace {

/// From 0: what is left of the error on the bundled recordings is below half a level.
constexpr int iterations = 20;

/// The passes of membrane.comp.
enum Pass {
  set_up,
  start,
  coarsen,
  invert,
  relax,
  restrict_residual,
  prolong,
  multiply_residual,
  find_beta,
  turn,
  apply,
  find_alpha,
  step,
  pass_count
};
constexpr std::array<const char*, pass_count> pass_names = {
    "SET_UP",    "START",    "COARSEN", "INVERT",
    "RELAX",     "RESTRICT", "PROLONG", "MULTIPLY_RESIDUAL",
    "FIND_BETA", "TURN",     "APPLY",   "FIND_ALPHA",
    "STEP"};

Program program_of(std::size_t pass) {
  std::string defines;
  for (std::size_t i = 0; i < pass_count; ++i) {
    defines += std::string("#define ") + pass_names[i] + " " + std::to_string(i) + "\n";
  }
  return compute_program({"membrane.comp"},
                         defines + "#define PASS " + std::to_string(pass) + "\n");
}

/// A grid of cells: where it begins in the arrays.
struct Grid {
  int first, width, height;
};

/// A pixel: its right side, and its anchor; -1: not to be solved for.
struct Cell {
  float value[3], anchor;
};

GLuint groups_across(const Grid& grid) {
  return static_cast<GLuint>((grid.width + 63) / 64);
}

}  // namespace

struct GpuMembraneSolver::Resources {
  Resources() {
    for (std::size_t i = 0; i < pass_count; ++i) programs.push_back(program_of(i));
  }

  std::vector<Program> programs;
  std::vector<Grid> grids;
  Buffer weights, right_sides, values, directions, images, solution, sums, scalars;
  std::array<BufferTexture, 6> textures;  ///< of the first six
  MappedBuffer uploaded{MappedBuffer::Use::upload};
  MappedBuffer downloaded{MappedBuffer::Use::download};

  Cell* cells() const { return reinterpret_cast<Cell*>(uploaded.data()); }

  /// Memory for a problem of this size.
  void reserve(int width, int height) {
    grids.assign(1, {0, width, height});
    while (grids.back().width > 1 || grids.back().height > 1) {
      const Grid& fine = grids.back();
      grids.push_back(
          {fine.first + fine.width * fine.height, (fine.width + 1) / 2, (fine.height + 1) / 2});
    }
    const std::size_t finest = sizeof(Cell) * static_cast<std::size_t>(width * height);
    const std::size_t all = sizeof(Cell) * static_cast<std::size_t>(grids.back().first + 1);
    Buffer* const buffers[] = {&weights, &right_sides, &values, &directions, &images, &solution};
    for (std::size_t i = 0; i < textures.size(); ++i) {
      const std::size_t bytes = i < 3 ? all : finest;
      if (buffers[i]->reserve(bytes)) {
        textures[i].create(*buffers[i], GL_RGBA32F, bytes / sizeof(Cell));
      }
    }
    sums.reserve(sizeof(Cell) * groups_across(grids.front()) * static_cast<std::size_t>(height));
    scalars.reserve(3 * sizeof(Cell));
    uploaded.reserve(finest);
    downloaded.reserve(finest);
  }

  void bind() const {
    const Buffer* const bound[] = {&weights, &right_sides, &values, &directions,
                                   &images,  &solution,    &sums,   &scalars};
    for (GLuint i = 0; i < std::size(bound); ++i) bound[i]->bind(i);
    for (GLuint i = 0; i < textures.size(); ++i) textures[i].bind(i);
  }

  /// Runs a pass over the cells of `over`.
  void run(Pass pass, const Grid& grid, const Grid& coarse, const Grid& over, int parity = 0,
           bool from_zero = false) const {
    const Program& program = programs[pass];
    program.use();
    glProgramUniform3i(program.name(), program.location("grid"), grid.first, grid.width,
                       grid.height);
    glProgramUniform3i(program.name(), program.location("coarse"), coarse.first, coarse.width,
                       coarse.height);
    program.set("parity", parity);
    program.set("from_zero", from_zero ? 1 : 0);
    glDispatchCompute(groups_across(over), static_cast<GLuint>(over.height), 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
  }
  void run(Pass pass, int parity = 0, bool from_zero = false) const {
    run(pass, grids.front(), grids.front(), grids.front(), parity, from_zero);
  }
  /// A pass of one group, which adds up what all groups have left.
  void run_sum(Pass pass) const {
    programs[pass].set("groups",
                       static_cast<int>(groups_across(grids.front())) * grids.front().height);
    run(pass, grids.front(), grids.front(), {0, 1, 1});
  }

  /// Values of the finest grid that its right sides, smoothed over, ask for. Symmetric: what is
  /// relaxed last on the way down is relaxed first on the way up.
  void precondition() const {
    for (std::size_t l = 0; l < grids.size(); ++l) {
      const Grid& grid = grids[l];
      run(relax, grid, grid, grid, 0, true);
      run(relax, grid, grid, grid, 1);
      if (l + 1 < grids.size()) run(restrict_residual, grid, grids[l + 1], grids[l + 1]);
    }
    for (std::size_t l = grids.size() - 1; l-- > 0;) {
      const Grid& grid = grids[l];
      run(prolong, grid, grids[l + 1], grid);
      run(relax, grid, grid, grid, 1);
      run(relax, grid, grid, grid, 0);
    }
  }
};

GpuMembraneSolver::GpuMembraneSolver() {
  const Current current(context_);
  resources_ = std::make_unique<Resources>();
  context_.check("making the membrane solver's programs");
}

GpuMembraneSolver::~GpuMembraneSolver() {
  delete_in(context_, resources_);
}

void GpuMembraneSolver::solve(float /*tolerance*/) {
  if (size() == 0) return;
  const Current current(context_);
  resources_->reserve(width(), height());
  pack();
  run();
  wait_until_done();
  context_.check("solving for a membrane");
}

/// A given value beside a pixel counts as an anchor there.
void GpuMembraneSolver::pack() {
  Cell* const cells = resources_->cells();
  const auto cell_at = [&](int x, int y) -> Cell& {
    return cells[static_cast<std::ptrdiff_t>(y) * width() + x];
  };
  for (int y = 0; y < height(); ++y) {
    for (int x = 0; x < width(); ++x) {
      cell_at(x, y) = {{0, 0, 0}, is_unknown(x, y) ? 0.F : -1.F};
    }
  }
  const auto add = [&](int x, int y, const Values& value, float anchor) {
    if (x < 0 || y < 0 || x >= width() || y >= height() || !is_unknown(x, y)) return;
    Cell& cell = cell_at(x, y);
    for (std::size_t c = 0; c < channels; ++c) cell.value[c] += value[c];
    cell.anchor += anchor;
  };
  for (const Boundary& fixed_value : fixed_values()) {
    const auto [x, y, value] = fixed_value;
    add(x - 1, y, fixed_value.value, 1);
    add(x + 1, y, fixed_value.value, 1);
    add(x, y - 1, fixed_value.value, 1);
    add(x, y + 1, fixed_value.value, 1);
  }
  for (const Boundary& source : sources()) add(source.x, source.y, source.value, 0);
}

void GpuMembraneSolver::run() {
  const Resources& r = *resources_;
  const std::size_t bytes = sizeof(Cell) * static_cast<std::size_t>(width() * height());
  copy(r.uploaded.name(), r.solution.name(), bytes);
  r.bind();
  r.run(set_up);
  r.run(start);
  for (std::size_t l = 0; l + 1 < r.grids.size(); ++l) {
    r.run(coarsen, r.grids[l], r.grids[l + 1], r.grids[l + 1]);
  }
  for (const Grid& grid : r.grids) r.run(invert, grid, grid, grid);
  for (int i = 0; i < iterations; ++i) {
    r.precondition();
    r.run(multiply_residual);
    r.run_sum(find_beta);
    r.run(turn);
    r.run(apply);
    r.run_sum(find_alpha);
    r.run(step);
  }
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  copy(r.solution.name(), r.downloaded.name(), bytes);
  glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
}

void GpuMembraneSolver::read_block(int y, int column, float* result) const {
  constexpr int block = MembraneLevel::tile_width;
  const auto* const cells = reinterpret_cast<const Cell*>(resources_->downloaded.data()) +
                            static_cast<std::ptrdiff_t>(y) * width() + column * block;
  const int count = std::min(block, width() - column * block);
  for (int c = 0; c < static_cast<int>(channels); ++c) {
    for (int i = 0; i < count; ++i) result[c * block + i] = cells[i].value[c];
  }
}

}  // namespace diminish::gl
