// SPDX-License-Identifier: Apache-2.0
#include "app/cli/methods.h"
#include "core/bake/bake_file.h"
#include "core/bake/gpu_layout.h"
#include "core/base/atomic_file.h"
#include "core/compare/field_noise.h"
#include "core/ivg/grid_advice.h"
#include "core/octree/light_octree.h"
#include "core/scene/thin_walls.h"
#include "core/voxel/voxel_advice.h"
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {
namespace {

constexpr std::uint64_t kNoisePoints = 1000;

std::optional<double> noiseOf(const Lighting& lighting)
{
    const LitScene& lit = lighting.lit;
    return statedNoise(*lighting.field, samplePoints(*lit.rays, *lit.lights, *lit.reach, kNoisePoints, 1));
}

nlohmann::json vec(glm::dvec3 v) { return {v.x, v.y, v.z}; }

/// Bytes of the arrays that textures are made from; null where a method has none or they would not fit.
nlohmann::json textureBytes(const IndirectField& field)
{
    const auto* octree = dynamic_cast<const LightOctree*>(&field);
    if (!octree) return nullptr;
    const Result<GpuOctree> gpu = makeGpuOctree(*octree);
    if (!gpu) return nullptr;
    return {{"bricks", gpu->bricks.size()},
            {"lights", 2 * gpu->vdls.size()},
            {"normals", gpu->normals.size()},
            {"all", gpu->memoryBytes()}};
}

/// Of an irradiance grid: cells, photons that were asked for or chosen, memory as computed before; else null.
nlohmann::json gridReport(const Lighting& lighting)
{
    const auto* grid = dynamic_cast<const IrradianceGrid*>(lighting.field.get());
    if (!grid) return nullptr;
    const auto ofLattice = [](const GridLattice& lattice) {
        return nlohmann::json{{"cells", {lattice.cells.x, lattice.cells.y, lattice.cells.z}},
                              {"cell_size", vec(glm::dvec3(lattice.cellSize))}};
    };
    nlohmann::json json = ofLattice(grid->geometry().lattice);
    json["photons_per_group"] = lighting.counters.photonsPerGroup;
    json["memory_bytes_before"] = lighting.counters.keptBytes;
    json["memory_bytes_most"] = lighting.counters.mostBytes;
    if (grid->inside().grid) json["inside"] = ofLattice(grid->inside().grid->geometry().lattice);
    return json;
}

void printGrid(const Lighting& lighting)
{
    const auto* grid = dynamic_cast<const IrradianceGrid*>(lighting.field.get());
    if (!grid) return;
    const auto told = [](const GridLattice& l) {
        return fmt::format("{} x {} x {} cells of {:.3g} x {:.3g} x {:.3g} m", l.cells.x, l.cells.y, l.cells.z,
                           l.cellSize.x, l.cellSize.y, l.cellSize.z);
    };
    const WorkCounters& c = lighting.counters;
    fmt::print("  grid: {}, {} photons per light group\n", told(grid->geometry().lattice), c.photonsPerGroup);
    if (grid->inside().grid) fmt::print("  inside it: {}\n", told(grid->inside().grid->geometry().lattice));
    fmt::print("  memory: {:.1f} MiB, {:.1f} MiB at most while it was made, as computed before\n",
               c.keptBytes / (1 << 20), c.mostBytes / (1 << 20));
}

/// Of voxel radiosity; else nothing.
std::optional<VoxelAdvice> adviceOf(const Lighting& lighting)
{
    const auto* field = dynamic_cast<const VoxelField*>(lighting.field.get());
    if (!field) return {};
    const LitScene& lit = lighting.lit;
    return voxelAdvice(*lit.rays, *lit.reach, samplePoints(*lit.rays, *lit.lights, *lit.reach, kNoisePoints, 1), *field,
                       lighting.params.voxelDirections);
}

/// Of voxel radiosity: how many voxels of what size, and what is too fine for them; else null.
nlohmann::json voxelReport(const Lighting& lighting)
{
    const auto* field = dynamic_cast<const VoxelField*>(lighting.field.get());
    if (!field) return nullptr;
    const VoxelAdvice advice = *adviceOf(lighting);
    nlohmann::json lamps = nlohmann::json::array();
    for (const VoxelAdvice::Lamp& lamp : advice.lamps) {
        lamps.push_back({{"id", lighting.lit.scene->groups[static_cast<std::size_t>(lamp.group)].id},
                         {"effective_emitters", lamp.emitters},
                         {"by_shadow_rays", lamp.isConnected}});
    }
    return {{"surface_in_gaps", advice.inGaps},
            {"surface_on_thin", advice.onThin},
            {"surface_on_thin_before_dark", advice.onThinBeforeDark},
            {"lamps", std::move(lamps)},
            {"voxels", field->surface().leaves->cells.size()},
            {"entries", field->surface().leaves->entries.size()},
            {"voxel_size", field->surface().leaves->cellSize()},
            {"bounces", lighting.counters.bounces}};
}

void printVoxels(const Lighting& lighting)
{
    const auto* field = dynamic_cast<const VoxelField*>(lighting.field.get());
    if (!field) return;
    const OctreeGeometry& leaves = *field->surface().leaves;
    fmt::print("  voxels: {} of {:.3g} m with {} entries, {} bounces\n", leaves.cells.size(), leaves.cellSize(),
               leaves.entries.size(), lighting.counters.bounces);
}

/// What is too fine for voxels.
void warnOfVoxels(const Context& context, const Lighting& lighting)
{
    const std::optional<VoxelAdvice> advice = adviceOf(lighting);
    if (!advice) return;
    for (const std::string& line : adviceLines(*advice, *lighting.lit.scene)) log(context.log, LogLevel::warning, line);
}

/// Light passes through walls that are too thin for the grid: told, with what parts them.
void warnOfThinWalls(const Context& context, const Lighting& lighting)
{
    const auto* grid = dynamic_cast<const IrradianceGrid*>(lighting.field.get());
    if (!grid) return;
    const ThinWallSearch walls = findThinWalls(*lighting.lit.scene);
    const glm::vec3 size = grid->geometry().lattice.cellSize;
    const float cell = std::max({size.x, size.y, size.z}), least = cell * leastWallCells(lighting.params.gridFilter);
    if (!walls.thinnest || walls.thinnest->thickness >= least) return;
    const glm::dvec3 at = lighting.lit.scene->toFile(walls.thinnest->at);
    log(context.log, LogLevel::warning,
        fmt::format(
            "a wall at ({:.3g}, {:.3g}, {:.3g}) is {:.3g} m thick; grid.filter={} on cells of {:.3g} m parts light "
            "from {:.3g} m on: some may leak through it; raise grid.size{}",
            at.x, at.y, at.z, walls.thinnest->thickness,
            kGridFilterNames[static_cast<std::size_t>(lighting.params.gridFilter)], cell, least,
            lighting.params.gridFilter == GridFilter::trilinear ? "" : " or use grid.filter=trilinear"));
}

/// Everything a program may want to know; timings and host are here and not in the file.
nlohmann::json report(const Lighting& lighting, const BakeInfo& info, std::optional<double> noise,
                      std::uint64_t fileBytes, int threads)
{
    const WorkCounters& c = lighting.counters;
    nlohmann::json stages = nlohmann::json::object(), stagesCpu = nlohmann::json::object();
    for (const StageCost& s : c.stages) stages[s.stage] = s.wallMs, stagesCpu[s.stage] = s.cpuMs;
    nlohmann::json params = nlohmann::json::object();
    for (const ParamSpec& spec : kParams) params[std::string(spec.key)] = paramText(info.params, spec);
    return {{"method", methodName(info.method)},
            {"program", info.program},
            {"isa", info.isa},
            {"threads", threads},
            {"scene_hash", toHex(info.sceneHash)},
            {"parameters", params},
            {"seconds", lighting.bakeSeconds},
            {"cpu_seconds", allCpuSeconds(c.stages)},
            {"stages_ms", stages},
            {"stages_cpu_ms", stagesCpu},
            {"noise", noise ? nlohmann::json(*noise) : nlohmann::json(nullptr)},
            {"memory_bytes", lighting.field->memoryBytes()},
            {"texture_bytes", textureBytes(*lighting.field)},
            {"file_bytes", fileBytes},
            {"work",
             {{"photons_shot", c.photonsShot},
              {"photons_stored", c.photonsStored},
              {"photons_caustic", c.causticPhotons},
              {"rays_traced", c.raysTraced},
              {"paths_cut_off", c.pathsCutOff},
              {"groups_baked", c.groupsBaked},
              {"groups_off", c.groupsOff},
              {"leaves", c.leaves},
              {"entries", c.entries},
              {"gathers", c.gathers},
              {"clusterings", c.clusterings},
              {"degenerate_entries", c.degenerateEntries},
              {"vertices", c.vertices},
              {"deposits", c.deposits},
              {"voxels", c.voxels},
              {"bounces", c.bounces}}},
            {"grid", gridReport(lighting)},
            {"voxels", voxelReport(lighting)},
            {"energy_lm",
             {{"emitted", vec(c.ledger.emitted)},
              {"absorbed", vec(c.ledger.absorbed)},
              {"escaped", vec(c.ledger.escaped)},
              {"terminated", vec(c.ledger.terminated)},
              {"missing", vec(c.ledger.missing())}}}};
}

void print(const Lighting& lighting, std::optional<double> noise, const std::string& output, std::uint64_t fileBytes)
{
    const WorkCounters& c = lighting.counters;
    fmt::print("{}: {:.2f} s, {:.2f} CPU-s", methodName(lighting.method), lighting.bakeSeconds,
               allCpuSeconds(c.stages));
    if (lighting.method != Method::voxelLightcuts)
        fmt::print(", {} photons shot, {} stored", c.photonsShot, c.photonsStored);
    if (lighting.method == Method::lightOctree) fmt::print(", {} leaves, {} entries", c.leaves, c.entries);
    if (lighting.method == Method::irradianceGrid)
        fmt::print(", {} vertices in the open, {} deposits", c.vertices, c.deposits);
    fmt::print("\n");
    printGrid(lighting);
    printVoxels(lighting);
    for (const StageCost& s : c.stages) fmt::print("  {:<12} {:9.1f} ms {:9.1f} CPU-ms\n", s.stage, s.wallMs, s.cpuMs);
    const double emitted = glm::dot(c.ledger.emitted, glm::dvec3(1.0));
    if (emitted > 0.0) {
        const auto share = [&](glm::dvec3 v) { return 100.0 * glm::dot(v, glm::dvec3(1.0)) / emitted; };
        fmt::print("  light: {:.1f} % absorbed, {:.1f} % escaped, {:.2g} % cut off\n", share(c.ledger.absorbed),
                   share(c.ledger.escaped), share(c.ledger.terminated));
    }
    if (noise) fmt::print("  noise: {:.1f} % of the mean, estimated from the photons themselves\n", 100.0 * *noise);
    fmt::print("{}: {:.1f} MiB\n", output, static_cast<double>(fileBytes) / (1 << 20));
}

} // namespace

int bake(const Context& context, const BakeCommand& command)
{
    const LightingRequest request{command.scene, command.method, {}, command.options};
    if (const Result<Done> checked = checkRequest(request); !checked) return failUsage(checked.error());
    const Method method = *methodNamed(command.method);
    if (method == Method::direct || method == Method::reference) {
        return failUsage(
            {Error::Kind::badInput, command.method + " keeps nothing to bake; use it with probe or render"});
    }
    if (const Result<Done> writable = checkOutput(command.output); !writable) return failWriting(writable.error());
    const Result<Lighting> lighting = prepareLighting(context, request, 1.0);
    if (!lighting) return fail(lighting.error());
    if (!context.quiet) warnOfThinWalls(context, *lighting);
    if (!context.quiet) warnOfVoxels(context, *lighting);
    const BakeInfo info = bakeInfo(*lighting);
    const Result<std::vector<std::uint8_t>> bytes = bakeBytes(*lighting->field, info, *lighting->lit.scene);
    if (!bytes) return fail(bytes.error());
    if (const Result<Done> wrote = writeFile(command.output, *bytes); !wrote) return failWriting(wrote.error());
    const std::optional<double> noise = context.quiet && !context.json ? std::nullopt : noiseOf(*lighting);
    if (context.json) {
        nlohmann::json json = report(*lighting, info, noise, bytes->size(), context.workers->threadCount());
        if (lighting->budget) json["budget"] = asJson(*lighting->budget);
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    } else if (!context.quiet) {
        print(*lighting, noise, command.output, bytes->size());
    }
    return kDone;
}

} // namespace lightloom::cli
