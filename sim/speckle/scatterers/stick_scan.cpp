#include "sim/speckle/scatterers/stick_scan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace wobblebench::sim {

namespace {

/// Queued cells are projected when there are this many, which keeps most SIMD lanes in use.
constexpr std::size_t kQueuedCells = 4 * std::size_t{kCellsPerBatch};
/// Largest position error of the linear map of a block that moves non-rigidly.
constexpr double kLinear_m = 2e-6;
/// Factor on the size of hash cells that move non-rigidly.
constexpr float kStretch = 1.5f;

/// True if the map is accurate at the cube's corners.
bool is_linear(const RestToBeam& map,
               const StickTransform& transform,
               const glm::dvec3& center,
               double side_m) {
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at =
        center +
        0.5 * side_m * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    if (glm::distance(map(at), transform.to_beam(at)) > kLinear_m) return false;
  }
  return true;
}

/// Direction of the sound, at rest.
glm::vec3 direction_of(const RestToBeam& map) {
  return glm::vec3(glm::normalize(glm::transpose(map.matrix)[0]));
}

}  // namespace

StickScan::StickScan(const ScattererScene& scene, const StickPath& path, ScanBuffers& buffers)
    : scene_(scene),
      path_(path),
      buffers_(buffers),
      beam_(scene.beam(path.line.ray)),
      transform_(scene.tissue, path.line),
      end_m_(EchoRange(scene, path).true_m) {}

std::uint64_t StickScan::run(std::span<std::complex<float>> iq) {
  find_touched_blocks(transform_, beam_.bounds, scene_.block_grid(), end_m_, buffers_.blocks);
  for (const TouchedBlock& touched : buffers_.blocks) {
    const TissueBlocks::Block tissue = scene_.blocks.block(touched.index);
    if (!scene_.blocks.anechoic(tissue)) scan(touched, tissue);
  }
  if (!begun_) return 0;
  project_pending();
  return buffers_.echoes.finish(iq);
}

std::uint64_t StickScan::run(std::span<const PointEcho> points, std::span<std::complex<float>> iq) {
  EchoQueue& echoes = buffers_.echoes;
  echoes.begin(scene_, path_);
  const AcrossStick across = across_stick(path_.line.ray);
  for (const PointEcho& point : points) {
    const glm::dvec3 from_face = point.position_m - path_.line.ray.origin;
    const glm::dvec3 at(glm::dot(from_face, path_.line.ray.direction),
                        glm::dot(from_face, across.lateral),
                        glm::dot(from_face, across.elevation));
    const PointScatterer scatterer{to_float(at), point.amplitude, scene_.table.row(at.x)};
    echoes.commit(project_point(scatterer, scene_.projection(beam_), echoes.reserve(1)));
  }
  return echoes.finish(iq);
}

void StickScan::begin() {
  begun_ = true;
  buffers_.echoes.begin(scene_, path_);
  for (const auto turn : {phantoms::Deformation::Turn::none, phantoms::Deformation::Turn::full}) {
    if (transform_.rigid() && turn == phantoms::Deformation::Turn::full) break;
    const auto part = static_cast<std::size_t>(turn);
    direction_[part] = direction_of(transform_.rigid_map(turn));
    fill_grids(transform_.rigid_map(turn), buffers_.rigid[part]);
  }
}

void StickScan::scan(const TouchedBlock& touched, const TissueBlocks::Block& tissue) {
  if (!begun_) begin();
  Block block;
  block.tissue = tissue;
  const BlockGrid grid = scene_.block_grid();
  const glm::dvec3 center = grid.center(touched.index);
  block.corner = center - 0.5 * grid.side_m;
  std::vector<OctaveCells>& octaves = locate_block(center, touched.turn, block);
  block.beam_corner = to_float(block.map(block.corner));
  const auto row = static_cast<std::size_t>(scene_.table.row(touched.center.x));
  block.reach = beam_.reaches[row];
  for (std::size_t i = 0; i < scene_.cells.octaves.size(); ++i) {
    if (!scene_.gains[i].contributes[row]) continue;
    scan_octave(block, octaves[i], static_cast<int>(i));
  }
}

void StickScan::fill_grids(const RestToBeam& map, std::vector<OctaveCells>& octaves) const {
  octaves.resize(scene_.cells.octaves.size());
  for (std::size_t i = 0; i < octaves.size(); ++i) {
    octaves[i].grid.fill(map, scene_.blocks.side_m(), scene_.cells.octaves[i].divisions);
  }
}

std::vector<OctaveCells>& StickScan::locate_block(const glm::dvec3& center,
                                                  phantoms::Deformation::Turn turn,
                                                  Block& block) {
  const double side_m = scene_.blocks.side_m();
  if (turn != phantoms::Deformation::Turn::partial) {
    const auto part = static_cast<std::size_t>(turn);
    block.map = transform_.rigid_map(turn);
    block.direction = direction_[part];
    return buffers_.rigid[part];
  }
  block.map = transform_.map_near(center);
  block.deforms = true;
  block.linear = is_linear(block.map, transform_, center, side_m);
  block.direction = direction_of(block.map);
  fill_grids(block.map, buffers_.deforming);
  return buffers_.deforming;
}

CellTest StickScan::cell_test(const Block& block, const CellGrid& grid, int octave) const {
  const float stretch = block.linear ? 1.0f : kStretch;
  const float half_axial_m = stretch * grid.half.axial;
  const auto& gain = scene_.gains[static_cast<std::size_t>(octave)];
  return {block.beam_corner,
          stretch * grid.half.lateral,
          stretch * grid.half.elevation,
          block.reach,
          std::max(gain.begin_m, -half_axial_m),
          std::min(gain.end_m, static_cast<float>(end_m_) + half_axial_m),
          scene_.rim};
}

void StickScan::write_cells(const Block& block,
                            const CellGrid& grid,
                            int count,
                            const HashCellArrays& to) const {
  const CellOrigin corner(block.beam_corner);
  for (int i = 0; i < count; ++i) {
    const std::int32_t number = buffers_.list[i];
    to.origin[i] = corner + grid.origins[static_cast<std::size_t>(number)];
    to.seed[i] = hash_cell_seed(block.key, static_cast<std::uint32_t>(number));
  }
}

void StickScan::scan_octave(Block& block, OctaveCells& cells, int octave) {
  const CellGrid& grid = cells.grid;
  block.key = scene_.cells.octaves[static_cast<std::size_t>(octave)].block_key(block.tissue.index);
  test_cells(grid.centers(), grid.count(), cell_test(block, grid, octave), buffers_.touched);
  if (block.deforms) {
    queue_deforming_cells(block, octave, cells);
  } else {
    queue_homogeneous_cells(block, octave, cells);
    if (block.tissue.mixed != nullptr) queue_mixed_cells(block, octave, cells);
  }
  project(cells, octave, kQueuedCells, block.deforms ? nullptr : &block.direction);
}

void StickScan::project(OctaveCells& cells,
                        int octave,
                        std::size_t enough,
                        const glm::vec3* direction) {
  if (cells.homogeneous.count >= enough) {
    project_homogeneous(cells.homogeneous, axes_of(cells, cells.homogeneous, direction), octave);
  }
  if (cells.mixed.count >= enough) {
    project_mixed(cells.mixed, axes_of(cells, cells.mixed, direction), octave, direction);
  }
}

CellAxes StickScan::axes_of(const OctaveCells& cells,
                            const HashCellQueue& queue,
                            const glm::vec3* direction) {
  return direction ? CellAxes{&cells.grid.axes, false} : CellAxes{queue.axes.data(), true};
}

void StickScan::project_pending() {
  for (std::size_t i = 0; i < scene_.cells.octaves.size(); ++i) {
    const int octave = static_cast<int>(i);
    for (std::size_t part = 0; part < 2; ++part) {
      if (buffers_.rigid[part].empty()) continue;
      project(buffers_.rigid[part][i], octave, 1, &direction_[part]);
    }
    if (!buffers_.deforming.empty()) project(buffers_.deforming[i], octave, 1, nullptr);
  }
}

int StickScan::list_touched(const Block& block, int octave, int count, CellKind wanted) {
  if (block.tissue.mixed == nullptr) return list_set_flags(buffers_.touched, count, buffers_.list);
  // The padding behind an octave's cells reads the next octave's kinds; those cells are not
  // touched.
  const CellKind* kinds = scene_.blocks.kinds(block.tissue, octave);
  select_kind(buffers_.touched, kinds, wanted, count, buffers_.selected);
  return list_set_flags(buffers_.selected, count, buffers_.list);
}

void StickScan::queue_homogeneous_cells(const Block& block, int octave, OctaveCells& cells) {
  const TissueBlocks& blocks = scene_.blocks;
  const CellGrid& grid = cells.grid;
  HashCellQueue& queue = cells.homogeneous;
  const int listed = list_touched(block, octave, grid.count(), CellKind::homogeneous);
  const HashCellArrays to = queue.reserve(static_cast<std::size_t>(listed));
  write_cells(block, grid, listed, to);
  if (block.tissue.mixed == nullptr) {
    std::fill_n(to.amplitude, listed, blocks.amplitude(block.tissue.material));
  } else {
    const std::int16_t* codes = blocks.codes(block.tissue, octave);
    for (int i = 0; i < listed; ++i) to.amplitude[i] = blocks.amplitude(codes[buffers_.list[i]]);
  }
  queue.count += static_cast<std::size_t>(listed);
}

void StickScan::queue_mixed_cells(const Block& block, int octave, OctaveCells& cells) {
  const std::int16_t* codes = scene_.blocks.codes(block.tissue, octave);
  const CellGrid& grid = cells.grid;
  HashCellQueue& queue = cells.mixed;
  const int listed = list_touched(block, octave, grid.count(), CellKind::mixed);
  const HashCellArrays to = queue.reserve(static_cast<std::size_t>(listed));
  write_cells(block, grid, listed, to);
  std::fill_n(to.amplitude, listed, 1.0f);
  for (int i = 0; i < listed; ++i) {
    const MixedCell* cell = &TissueBlocks::mixed_cell(block.tissue, codes[buffers_.list[i]]);
    __builtin_prefetch(cell);
    queue.blocks[queue.count] = block.tissue.mixed;
    queue.mixed[queue.count++] = cell;
  }
}

void StickScan::queue_deforming_cells(const Block& block, int octave, OctaveCells& cells) {
  const TissueBlocks& blocks = scene_.blocks;
  const CellGrid& grid = cells.grid;
  const CellOrigin corner(block.beam_corner);
  const int listed = list_set_flags(buffers_.touched, grid.count(), buffers_.list);
  for (int i = 0; i < listed; ++i) {
    const std::int32_t number = buffers_.list[i];
    const int code = blocks.code(block.tissue, octave, number);
    const float amplitude = code >= 0 ? blocks.amplitude(code) : 1.0f;
    if (amplitude == 0) continue;
    HashCellQueue& queue = code >= 0 ? cells.homogeneous : cells.mixed;
    const HashCellArrays cell = queue.reserve(1);
    cell.seed[0] = hash_cell_seed(block.key, static_cast<std::uint32_t>(number));
    cell.amplitude[0] = amplitude;
    if (block.linear) {
      cell.origin[0] = corner + grid.origins[static_cast<std::size_t>(number)];
      queue.axes[queue.count] = grid.axes;
    } else {
      queue.axes[queue.count] = locate_deforming_cell(block, octave, number, cell.origin[0]);
    }
    if (code < 0) {
      queue.mixed[queue.count] = &TissueBlocks::mixed_cell(block.tissue, code);
      queue.blocks[queue.count] = block.tissue.mixed;
      queue.directions[queue.count] = block.direction;
    }
    ++queue.count;
  }
}

HashAxes StickScan::locate_deforming_cell(const Block& block,
                                          int octave,
                                          int number,
                                          CellOrigin& origin) const {
  const int n = scene_.cells.octaves[static_cast<std::size_t>(octave)].divisions;
  const double cell_m = scene_.blocks.side_m() / n;
  const glm::dvec3 low = block.corner + cell_m * cell_coordinates(number, n);
  const RestToBeam map = transform_.map_near(low + 0.5 * cell_m);
  origin = cell_origin(map, low, cell_m);
  return hash_axes(map, cell_m);
}

void StickScan::project_homogeneous(HashCellQueue& queue, const CellAxes& axes, int octave) {
  EchoQueue& echoes = buffers_.echoes;
  echoes.commit(
      project_scatterers(queue.cells(),
                         static_cast<int>(queue.count),
                         axes,
                         scene_.projection(beam_, &scene_.gains[static_cast<std::size_t>(octave)]),
                         echoes.reserve(queue.count * kScatterersInCell)));
  queue.count = 0;
}

void StickScan::project_mixed(HashCellQueue& queue,
                              const CellAxes& axes,
                              int octave,
                              const glm::vec3* direction) {
  EchoQueue& echoes = buffers_.echoes;
  const ProjectedScatterers projected = echoes.reserve(queue.count * kScatterersInCell);
  buffers_.hits.resize(std::max(buffers_.hits.size(), queue.count * kScatterersInCell));
  for (std::size_t i = 0; i < queue.count; ++i) {
    __builtin_prefetch(queue.blocks[i]->interfaces.data() + queue.mixed[i]->first_interface);
  }
  MixedCellHits mixed{queue.mixed.data(), buffers_.hits.data()};
  const int count =
      project_scatterers(queue.cells(),
                         static_cast<int>(queue.count),
                         axes,
                         scene_.projection(beam_, &scene_.gains[static_cast<std::size_t>(octave)]),
                         projected,
                         &mixed);
  for (int i = 0; i < mixed.hit_count; ++i) {
    const InterfaceHit& hit = buffers_.hits[static_cast<std::size_t>(i)];
    const auto cell = static_cast<std::size_t>(hit.cell);
    const ScattererEcho echo =
        scene_.blocks.interface_echo(*queue.blocks[cell],
                                     *queue.mixed[cell],
                                     hit.scatterer,
                                     direction ? *direction : queue.directions[cell]);
    float& range_m = projected.range_m[hit.projected];
    projected.amplitude[hit.projected] *=
        echo.amplitude * echoes.front_gain(echo.interface, range_m);
  }
  echoes.commit(count);
  queue.count = 0;
}

}  // namespace wobblebench::sim
