// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf_check.h"
#include "core/scene/gltf_check_parts.h"
#include "core/scene/gltf_files.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>

namespace lightloom {
namespace detail {

const Json& GltfFile::list(const char* name) const
{
    return JsonObject(root, "glTF", -1, faults).array(name, limits.entries);
}

JsonObject GltfFile::entry(const char* name, std::uint64_t i) const
{
    return {root.at(name).at(i), name, static_cast<std::int64_t>(i), faults};
}

std::uint64_t GltfFile::size(const char* name) const
{
    const auto found = root.find(name);
    return found == root.end() || !found->is_array() ? 0 : found->size();
}

} // namespace detail

namespace {

constexpr std::array kSupported{
    "KHR_lights_punctual",   "KHR_materials_emissive_strength",
    "KHR_texture_transform", "KHR_materials_transmission",
    "KHR_materials_ior",     "KHR_materials_volume",
    "KHR_mesh_quantization",
};
constexpr std::array kLists{"scenes",   "nodes",  "meshes",   "accessors", "bufferViews", "buffers", "materials",
                            "textures", "images", "samplers", "cameras",   "animations",  "skins"};

bool isSupported(const std::string& extension)
{
    return std::find(kSupported.begin(), kSupported.end(), extension) != kSupported.end();
}

void checkAsset(const JsonObject& root)
{
    if (!root.has("asset")) {
        root.fault("it is JSON, but not a glTF file: \"asset\" is missing");
        return;
    }
    const JsonObject asset = root.object("asset");
    const std::string version = asset.text("version"), least = asset.text("minVersion");
    if (!version.starts_with("2."))
        asset.fault(fmt::format("version is \"{}\"; only glTF 2 is read", plainName(version)),
                    Error::Kind::unsupported);
    if (!least.empty() && least != "2.0") {
        asset.fault(fmt::format("minVersion is \"{}\"; only glTF 2.0 is read", plainName(least)),
                    Error::Kind::unsupported);
    }
}

/// Error for a required extension that we lack; a warning for each that is merely used.
void checkExtensions(const JsonObject& root, const GltfLimits& limits, std::vector<std::string>& warnings)
{
    std::set<std::string> ignored;
    for (const char* key : {"extensionsRequired", "extensionsUsed"}) {
        for (const Json& entry : root.array(key, limits.entries)) {
            if (!entry.is_string()) {
                root.fault(fmt::format("{} holds something that is not a name", key));
                return;
            }
            const auto name = entry.get<std::string>();
            if (isSupported(name)) continue;
            if (std::string_view(key) == "extensionsRequired") {
                root.fault(fmt::format("the file requires the extension {}, which Lightloom does not read; export it "
                                       "without",
                                       plainName(name)),
                           Error::Kind::unsupported);
                return;
            }
            ignored.insert(name);
        }
    }
    for (const std::string& name : ignored) {
        warnings.push_back(fmt::format("the extension {} is ignored", plainName(name)));
    }
}

void warnOfIgnored(const detail::GltfFile& file, std::vector<std::string>& warnings)
{
    if (file.size("skins") > 0) warnings.emplace_back("skins are ignored: meshes stand as they are stored");
    if (file.size("animations") > 0) warnings.emplace_back("animations are ignored: nodes stand as they are stored");
    for (const Json& mesh : file.list("meshes")) {
        if (!mesh.contains("primitives")) continue;
        for (const Json& primitive : mesh["primitives"]) {
            if (!primitive.contains("targets")) continue;
            warnings.emplace_back("morph targets are ignored");
            return;
        }
    }
}

/// Opens the buffers, each cut to its byteLength.
Result<Done> fetchBuffers(detail::GltfFile& file, const GltfContainer& container, const UriReader& readUri,
                          std::vector<std::vector<std::uint8_t>>& storage)
{
    std::uint64_t total = 0;
    for (std::uint64_t i = 0; i < file.size("buffers"); ++i) {
        const JsonObject buffer = file.entry("buffers", i);
        const auto length = buffer.needWhole("byteLength", file.limits.fileBytes);
        const std::string uri = buffer.text("uri");
        if (file.faults.any()) return file.faults.first();
        total += *length;
        if (total > file.limits.bufferBytes) {
            return Error{Error::Kind::outOfMemory,
                         fmt::format("the buffers hold more than {} bytes in all", file.limits.bufferBytes)};
        }
        std::span<const std::uint8_t> bytes = container.binary;
        if (buffer.has("uri")) {
            Result<std::vector<std::uint8_t>> read = readUri(uri, file.limits.fileBytes);
            if (!read) return read.error().in(buffer.place());
            storage.push_back(*std::move(read));
            bytes = storage.back();
        } else if (i != 0 || !container.hasBinary) {
            return Error{Error::Kind::badInput, buffer.place() + ": it has no uri, and no data in the file"};
        }
        if (bytes.size() < *length) {
            return Error{Error::Kind::badInput, fmt::format("{}: byteLength is {}, but there are only {} bytes",
                                                            buffer.place(), *length, bytes.size())};
        }
        file.buffers.push_back(bytes.first(*length));
    }
    return Done{};
}

std::vector<GltfImageSource> imageSources(const detail::GltfFile& file)
{
    std::vector<GltfImageSource> sources;
    for (std::uint64_t i = 0; i < file.size("images"); ++i) {
        const JsonObject image = file.entry("images", i);
        GltfImageSource source;
        source.name = plainName(image.text("name"));
        source.uri = image.text("uri");
        const auto view = image.index("bufferView", "bufferViews", file.size("bufferViews"));
        if (source.uri.empty() && !view) image.fault("it has neither a uri nor a bufferView");
        if (!source.uri.empty() && !isDataUri(source.uri)) {
            if (const auto path = relativePath(source.uri); !path) file.faults.add(path.error().in(image.place()));
        }
        if (file.faults.any()) break;
        if (source.uri.empty()) source.bytes = detail::viewBytes(file, *view);
        if (source.name.empty()) {
            source.name =
                isDataUri(source.uri) || source.uri.empty() ? fmt::format("image {}", i) : plainName(source.uri);
        }
        sources.push_back(std::move(source));
    }
    return sources;
}

/// tinygltf cuts whole numbers in extensions to 32 bits: larger ones (3e9 written out) must look like fractions.
void widenLargeNumbers(Json& tree)
{
    constexpr double kMost = 2147483647.0;
    if (tree.is_number_integer() && std::abs(tree.get<double>()) > kMost) tree = tree.get<double>();
    if (tree.is_structured()) {
        for (Json& part : tree) widenLargeNumbers(part); // as deep as the guard let through
    }
}

/// The tree without what the next reader is better off not seeing: it would open files, decode images, or follow
/// references that nobody needs.
std::string strippedText(Json& root)
{
    for (const char* key : {"buffers", "images", "animations", "skins"}) root.erase(key);
    if (root.contains("nodes")) {
        for (Json& node : root["nodes"]) {
            for (const char* key : {"skin", "weights"}) node.erase(key);
        }
    }
    if (root.contains("meshes")) {
        for (Json& mesh : root["meshes"]) {
            mesh.erase("weights");
            if (!mesh.contains("primitives")) mesh["primitives"] = Json::array();
            for (Json& primitive : mesh["primitives"]) primitive.erase("targets");
        }
    }
    widenLargeNumbers(root);
    return root.dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace

Result<CheckedGltf> checkGltf(std::vector<std::uint8_t> bytes, const UriReader& readUri, const GltfLimits& limits)
{
    CheckedGltf checked;
    checked.storage.push_back(std::move(bytes));
    const Result<GltfContainer> container = openContainer(checked.storage.front());
    if (!container) return container.error();
    Result<Json> root = parseJson(container->json, {limits.jsonBytes, limits.jsonValues, limits.jsonDepth});
    if (!root) return root.error();

    Faults faults;
    detail::GltfFile file{*root, limits, faults, {}};
    const JsonObject top(*root, "glTF", -1, faults);
    checkAsset(top);
    checkExtensions(top, limits, checked.warnings);
    for (const char* name : kLists) static_cast<void>(file.list(name)); // reports one that is no list, or too long
    if (faults.any()) return faults.first();
    if (const Result<Done> fetched = fetchBuffers(file, *container, readUri, checked.storage); !fetched) {
        return fetched.error();
    }
    using namespace detail;
    for (const auto check :
         {checkBufferViews, checkAccessors, checkMeshes, checkNodes, checkLampsAndCameras, checkMaterials}) {
        check(file);
        if (faults.any()) return faults.first();
    }
    checked.images = imageSources(file);
    if (faults.any()) return faults.first();
    warnOfIgnored(file, checked.warnings);
    checked.buffers = std::move(file.buffers);
    checked.json = strippedText(*root);
    return checked;
}

} // namespace lightloom
