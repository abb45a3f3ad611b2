// SPDX-License-Identifier: Apache-2.0
#include "core/bake/volume_file.h"
#include "core/bake/vdb_seal.h"
#include "core/params/param_text.h"
#include <fmt/format.h>

namespace lightloom {
namespace {

void describe(const BakeInfo& info, VdbFile& file)
{
    file.set("creator", "Lightloom " + info.program);
    file.set("lightloom.unit", std::string("lux"));
    file.set("lightloom.method", std::string(methodName(info.method)));
    file.set("lightloom.scene", toHex(info.sceneHash));
    file.set("lightloom.isa", info.isa);
    if (!info.incomplete.empty()) file.set("lightloom.incomplete", info.incomplete);
    for (const ParamSpec& spec : kParams) {
        file.set(fmt::format("lightloom.{}", spec.key), paramText(info.params, spec));
    }
}

} // namespace

Result<std::vector<std::uint8_t>> volumeBytes(const BakeInfo& info, const std::function<void(VdbFile&)>& addGrids)
try {
    VdbFile file;
    describe(info, file);
    addGrids(file);
    const std::string bytes = withContentUuid(file.bytes());
    return std::vector<std::uint8_t>(bytes.begin(), bytes.end());
} catch (const std::bad_alloc&) {
    return Error{Error::Kind::outOfMemory, "not enough memory for the volume"};
} catch (const std::exception& failure) {
    return Error{Error::Kind::io, fmt::format("the volume could not be made: {}", failure.what())};
}

} // namespace lightloom
