// SPDX-License-Identifier: Apache-2.0
#include "core/bake/bake_file.h"
#include "core/bake/vdb_grids.h"
#include "core/bake/vdb_seal.h"
#include "core/base/atomic_file.h"
#include "core/params/param_text.h"
#include <algorithm>
#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <sstream>

namespace lightloom {
namespace {

using vdb::escaped;

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

openvdb::MetaMap metadata(const BakeInfo& info)
{
    openvdb::MetaMap meta;
    meta.insertMeta("lightloom.format", openvdb::Int32Metadata(kBakeFormat));
    meta.insertMeta("lightloom.method", openvdb::StringMetadata(std::string(methodName(info.method))));
    meta.insertMeta("lightloom.program", openvdb::StringMetadata(info.program));
    meta.insertMeta("lightloom.parameters", openvdb::StringMetadata(parameterText(info.params)));
    meta.insertMeta("lightloom.isa", openvdb::StringMetadata(info.isa));
    meta.insertMeta("lightloom.scene", openvdb::StringMetadata(toHex(info.sceneHash)));
    meta.insertMeta("lightloom.groups", openvdb::StringMetadata(joined(info.groups)));
    meta.insertMeta("lightloom.off", openvdb::StringMetadata(joined(info.off)));
    return meta;
}

/// What must hold before grids are looked at.
Result<BakeInfo> checkInfo(const openvdb::MetaMap& meta, const Scene& scene)
{
    const auto bad = [](std::string why) { return Error{Error::Kind::badInput, std::move(why)}; };
    const int format = meta.metaValue<std::int32_t>("lightloom.format");
    if (format > kBakeFormat) {
        return bad(fmt::format("the bake has format {}, this program reads up to {}; use a newer Lightloom", format,
                               kBakeFormat));
    }
    if (format < kBakeFormat) {
        return bad(fmt::format("the bake has format {}, from before the first release; bake again", format));
    }
    BakeInfo info;
    const Result<Method> method = methodNamed(meta.metaValue<std::string>("lightloom.method"));
    if (!method) return method.error();
    info.method = *method;
    for (const std::string& line : lines(meta.metaValue<std::string>("lightloom.parameters"))) {
        Result<BakeParams> params = withAssignment(info.params, line);
        if (!params) return params.error();
        info.params = *params;
    }
    info.isa = meta.metaValue<std::string>("lightloom.isa");
    info.program = meta.metaValue<std::string>("lightloom.program");
    info.sceneHash = sceneHash(scene);
    if (toHex(info.sceneHash) != meta.metaValue<std::string>("lightloom.scene")) {
        return bad("the bake was made for another scene (or the scene has changed since); bake again");
    }
    const std::vector<std::string> off = lines(meta.metaValue<std::string>("lightloom.off"));
    for (const LightGroup& group : scene.groups) {
        info.groups.push_back(group.id);
        if (std::ranges::find(off, escaped(group.id)) != off.end()) info.off.push_back(group.id);
    }
    return info;
}

} // namespace

Result<std::vector<std::uint8_t>> bakeBytes(const IndirectField& field, const BakeInfo& info, const Scene& scene)
try {
    openvdb::initialize();
    std::ostringstream stream(std::ios_base::binary);
    stream.exceptions(std::ios_base::failbit | std::ios_base::badbit);
    openvdb::MetaMap meta = metadata(info);
    openvdb::GridPtrVec grids;
    if (const auto* octree = dynamic_cast<const LightOctree*>(&field)) {
        grids = vdb::octreeGrids(*octree, scene, meta);
    } else if (const auto* map = dynamic_cast<const PhotonMapField*>(&field)) {
        grids = vdb::photonGrids(*map, scene);
    } else {
        return Error{Error::Kind::unsupported, fmt::format("{} keeps nothing that a file could hold", field.method())};
    }
    openvdb::io::Stream(stream).write(grids, meta);
    return sealVdb(std::move(stream).str());
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

Result<BakeFile> bakeFromBytes(std::span<const std::uint8_t> file, const Scene& scene)
try {
    const Result<std::span<const std::uint8_t>> content = openSeal(file);
    if (!content) return content.error();
    openvdb::initialize();
    std::istringstream stream(std::string(content->begin(), content->end()), std::ios_base::binary);
    openvdb::io::Stream stored(stream, false);
    const openvdb::MetaMap::ConstPtr meta = stored.getMetadata(); // a copy, made anew at each call: kept for the reader
    const Result<BakeInfo> info = checkInfo(*meta, scene);
    if (!info) return info.error();
    const vdb::NamedGrids grids(*stored.getGrids());
    std::vector<bool> isOn;
    for (const LightGroup& group : scene.groups) {
        isOn.push_back(std::ranges::find(info->off, group.id) == info->off.end());
    }
    BakeFile bake{*info, nullptr, {}};
    if (info->method == Method::lightOctree) {
        bake.octree = vdb::readOctree(grids, *meta, scene, isOn, info->params.vdlForm);
        return bake;
    }
    for (std::size_t g = 0; g < isOn.size(); ++g) {
        bake.photons.push_back(isOn[g] ? vdb::readPhotons(grids, scene, static_cast<int>(g)) : nullptr);
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
