// SPDX-License-Identifier: Apache-2.0
#include "core/bake/bake_file.h"
#include "core/bake/bake_grids.h"
#include "core/bake/vdb_seal.h"
#include "core/base/atomic_file.h"
#include "core/params/param_text.h"
#include <algorithm>
#include <fmt/format.h>
#include <sstream>

namespace lightloom {
namespace {

constexpr std::uint64_t kMostBytes = 64ull << 30;

std::string parameterText(const BakeParams& params)
{
    std::string text;
    for (const ParamSpec& spec : kParams) text += fmt::format("{}={}\n", spec.key, paramText(params, spec));
    return text;
}

std::vector<std::string> lines(const std::string& text)
{
    std::vector<std::string> found;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) found.push_back(line);
    return found;
}

/// Ids are free text: a line break in one would make two.
std::string joined(const std::vector<std::string>& ids)
{
    std::string text;
    for (const std::string& id : ids) text += escaped(id) + "\n";
    return text;
}

void describe(const BakeInfo& info, VdbFile& file)
{
    file.set("lightloom.format", std::int64_t(kBakeFormat));
    file.set("lightloom.method", std::string(methodName(info.method)));
    file.set("lightloom.program", info.program);
    file.set("lightloom.parameters", parameterText(info.params));
    file.set("lightloom.isa", info.isa);
    file.set("lightloom.scene", toHex(info.sceneHash));
    file.set("lightloom.groups", joined(info.groups));
    file.set("lightloom.off", joined(info.off));
}

/// What must hold before grids are looked at.
Result<BakeInfo> checkInfo(const VdbFile& file, const Scene& scene)
{
    const auto bad = [](std::string why) { return Error{Error::Kind::badInput, std::move(why)}; };
    const std::int64_t format = file.integer("lightloom.format");
    if (format > kBakeFormat) {
        return bad(fmt::format("the bake has format {}, this program reads up to {}; use a newer Lightloom", format,
                               kBakeFormat));
    }
    BakeInfo info;
    const Result<Method> method = methodNamed(file.text("lightloom.method"));
    if (!method) return method.error();
    info.method = *method;
    if (format < 2) { // of before these could be chosen
        info.params.gatherFit = GatherFit::mean;
        info.params.gatherAdapt = Switch::off;
    }
    if (format < 3) info.params.octreeDetail = 0; // of before leaves could be split
    info.params.gatherScreens = Switch::off;      // of before walls were looked for: newer ones say so
    info.params.gridFit = Switch::off;            // likewise of before light was fitted to surface
    info.params.gridSmooth = Switch::off;         // or smoothed
    info.params.voxelSmooth = VoxelSmooth::off;   // and of before voxels' light was averaged, and shot by mirrors
    info.params.voxelSlivers = 0.0f;
    info.params.voxelPhotons = 0;
    for (const std::string& line : lines(file.text("lightloom.parameters"))) {
        Result<BakeParams> params = withAssignment(info.params, line);
        if (!params) return params.error();
        info.params = *params;
    }
    info.isa = file.text("lightloom.isa");
    info.program = file.text("lightloom.program");
    info.sceneHash = sceneHash(scene);
    if (toHex(info.sceneHash) != file.text("lightloom.scene")) {
        return bad("the bake was made for another scene (or the scene has changed since); bake again");
    }
    const std::vector<std::string> off = lines(file.text("lightloom.off"));
    for (const LightGroup& group : scene.groups) {
        info.groups.push_back(group.id);
        if (std::ranges::find(off, escaped(group.id)) != off.end()) info.off.push_back(group.id);
    }
    return info;
}

} // namespace

std::string escaped(const std::string& id)
{
    std::string out;
    for (const char c : id) {
        if (c == '/' || c == '%' || static_cast<unsigned char>(c) < 32) {
            out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
        } else {
            out += c;
        }
    }
    return out;
}

Result<std::vector<std::uint8_t>> bakeBytes(const IndirectField& field, const BakeInfo& info, const Scene& scene)
try {
    VdbFile file;
    describe(info, file);
    if (const auto* octree = dynamic_cast<const LightOctree*>(&field)) {
        storeOctree(*octree, scene, file);
    } else if (const auto* grid = dynamic_cast<const IrradianceGrid*>(&field)) {
        storeGrid(*grid, scene, file);
    } else if (const auto* voxels = dynamic_cast<const VoxelField*>(&field)) {
        storeVoxels(*voxels, scene, file);
    } else if (const auto* map = dynamic_cast<const PhotonMapField*>(&field)) {
        storePhotons(*map, scene, file);
    } else {
        return Error{Error::Kind::unsupported, fmt::format("{} keeps nothing that a file could hold", field.method())};
    }
    return sealVdb(file.bytes());
} catch (const std::exception& failure) {
    return Error{Error::Kind::io, fmt::format("the bake could not be put into a file: {}", failure.what())};
}

Result<Done> writeBake(const std::filesystem::path& path, const IndirectField& field, const BakeInfo& info,
                       const Scene& scene)
{
    const Result<std::vector<std::uint8_t>> bytes = bakeBytes(field, info, scene);
    if (!bytes) return bytes.error();
    return writeFile(path, *bytes);
}

Result<BakeFile> bakeFromBytes(std::span<const std::uint8_t> bytes, const Scene& scene)
try {
    const Result<std::span<const std::uint8_t>> content = openSeal(bytes);
    if (!content) return content.error();
    const VdbFile file(std::string(content->begin(), content->end()));
    const Result<BakeInfo> info = checkInfo(file, scene);
    if (!info) return info.error();
    std::vector<bool> isOn;
    for (const LightGroup& group : scene.groups) {
        isOn.push_back(std::ranges::find(info->off, group.id) == info->off.end());
    }
    BakeFile bake{*info, nullptr, nullptr, nullptr, {}, {}};
    if (info->method == Method::lightOctree) {
        bake.octree = readOctree(file, scene, isOn, info->params);
        return bake;
    }
    if (info->method == Method::irradianceGrid) {
        bake.grid = readGrid(file, scene, isOn, info->params);
        return bake;
    }
    if (info->method == Method::voxelLightcuts) {
        bake.voxels = readVoxels(file, scene, isOn, info->params);
        return bake;
    }
    for (std::size_t g = 0; g < isOn.size(); ++g) {
        bake.photons.push_back(isOn[g] ? readPhotons(file, scene, static_cast<int>(g)) : nullptr);
        if (info->params.photonLookup != PhotonLookup::christensen) continue;
        bake.caches.push_back(isOn[g] ? readCache(file, scene, static_cast<int>(g)) : ChristensenCache::Values());
    }
    return bake;
} catch (const std::exception& failure) {
    return Error{Error::Kind::badInput, fmt::format("not a Lightloom bake: {}", failure.what())};
}

Result<BakeFile> readBake(const std::filesystem::path& path, const Scene& scene)
{
    const Result<std::vector<std::uint8_t>> bytes = readFile(path, kMostBytes);
    if (!bytes) return bytes.error();
    Result<BakeFile> file = bakeFromBytes(*bytes, scene);
    if (!file) return file.error().in(path.string());
    return file;
}

} // namespace lightloom
