// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf_reader.h"
#include "core/base/atomic_file.h"
#include "core/scene/gltf_check.h"
#include "core/scene/gltf_files.h"
#include "core/scene/gltf_json.h"
#include "core/scene/gltf_materials.h"
#include "core/scene/gltf_meshes.h"
#include "core/scene/gltf_nodes.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <tiny_gltf.h>

namespace lightloom {
namespace fs = std::filesystem;
namespace {

Error bad(std::string message) { return {Error::Kind::badInput, std::move(message)}; }

/// tinygltf on text that names no buffer and no image: it has nothing to open or decode. Should it try all the same,
/// these callbacks say no.
Result<tinygltf::Model> parseModel(const std::string& json)
{
    tinygltf::TinyGLTF parser;
    parser.SetFsCallbacks(
        {[](const std::string&, void*) { return false; }, [](const std::string& path, void*) { return path; },
         [](std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; },
         [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }, nullptr});
    parser.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*,
                             int, void*) { return false; },
                          nullptr);
    Result<tinygltf::Model> model = tinygltf::Model();
    std::string errors, warnings;
    if (parser.LoadASCIIFromString(&*model, &errors, &warnings, json.c_str(), static_cast<unsigned int>(json.size()),
                                   "")) {
        return model;
    }
    std::string line = plainName(errors.substr(0, errors.find('\n')));
    return bad(fmt::format("the glTF structure is damaged ({})", line.empty() ? "no reason given" : line));
}

/// Puts everything into one Scene, step by step.
class SceneMaker {
public:
    SceneMaker(const tinygltf::Model& model, const CheckedGltf& checked, const SceneFolder& folder,
               const std::stop_token& stop)
        : model_(model), checked_(checked), folder_(folder), stop_(stop), data_(model, checked.buffers)
    {
        for (const std::string& line : checked.warnings) warnings_.add(line);
    }

    Result<std::shared_ptr<const Scene>> make()
    {
        for (const auto step : {&SceneMaker::placeMeshes, &SceneMaker::findOrigin, &SceneMaker::addInstances,
                                &SceneMaker::addLampsAndCameras, &SceneMaker::addMaterials, &SceneMaker::finish}) {
            if (stop_.stop_requested()) return readingStopped();
            if (const Result<Done> done = (this->*step)(); !done) return done.error();
        }
        return std::shared_ptr<const Scene>(std::move(scene_));
    }

private:
    [[nodiscard]] int meshOf(const PlacedNode& node) const
    {
        return model_.nodes[static_cast<std::size_t>(node.node)].mesh;
    }

    Result<Done> placeMeshes()
    {
        Result<std::vector<PlacedNode>> placed = placeNodes(model_, warnings_);
        if (!placed) return placed.error();
        nodes_ = *std::move(placed);
        std::vector<bool> wanted(model_.meshes.size(), false);
        for (const PlacedNode& node : nodes_) {
            if (meshOf(node) >= 0) wanted[static_cast<std::size_t>(meshOf(node))] = true;
        }
        Result<std::vector<GltfMesh>> meshes = readMeshes(model_, data_, wanted, *scene_, warnings_, stop_);
        if (!meshes) return meshes.error();
        meshes_ = *std::move(meshes);
        dropFlattened();
        return Done{};
    }

    /// A node scaled to nothing along an axis has no inside and no normals to transform; animations hide things so.
    void dropFlattened()
    {
        const auto isFlattened = [](const glm::dmat4& m) {
            const glm::dvec3 x(m[0]), y(m[1]), z(m[2]);
            const double box = glm::length(x) * glm::length(y) * glm::length(z);
            return !(std::abs(glm::dot(glm::cross(x, y), z)) > 1e-12 * box);
        };
        for (PlacedNode& node : nodes_) {
            if (meshOf(node) < 0 || !isFlattened(node.toWorld)) continue;
            warnings_.add("meshes on nodes that are scaled to nothing are left out");
            flattened_.insert(node.node);
        }
    }

    /// Calls `take(node, mesh)` for each mesh in its place.
    template<class Take>
    void forMeshes(Take take) const
    {
        for (const PlacedNode& node : nodes_) {
            if (meshOf(node) < 0 || flattened_.contains(node.node)) continue;
            take(node, meshes_[static_cast<std::size_t>(meshOf(node))]);
        }
    }

    /// The bound of all triangles in double; its centre becomes the origin.
    Result<Done> findOrigin()
    {
        std::uint64_t triangles = 0, corners = 0;
        forMeshes([&](const PlacedNode&, const GltfMesh& mesh) {
            for (const int part : mesh.parts) {
                triangles += scene_->meshes[static_cast<std::size_t>(part)].triangles.size();
                corners += scene_->meshes[static_cast<std::size_t>(part)].positions.size();
            }
        });
        if (triangles == 0) return bad("it has no triangles: there is nothing that light could fall on");
        if (triangles > kMostTriangles || corners > 3 * kMostTriangles) {
            return Error{Error::Kind::outOfMemory,
                         fmt::format("it has {} triangles, instances counted each; at most {} are read", triangles,
                                     kMostTriangles)};
        }
        glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
        forMeshes([&](const PlacedNode& node, const GltfMesh& mesh) {
            for (const int part : mesh.parts) {
                for (const glm::vec3 p : scene_->meshes[static_cast<std::size_t>(part)].positions) {
                    const glm::dvec3 world(node.toWorld * glm::dvec4(glm::dvec3(p) + mesh.shift, 1.0));
                    low = glm::min(low, world);
                    high = glm::max(high, world);
                }
            }
        });
        constexpr double kFarthest = 1e12, kSmallest = 1e-9; // metres; squares of both are ordinary floats
        const double size = glm::length(high - low), farthest = std::max(glm::length(low), glm::length(high));
        if (!(farthest <= kFarthest && size >= kSmallest)) {
            return bad(
                fmt::format("it is {:.3g} m across and reaches to {:.3g} m from the origin; sizes from {:g} m on "
                            "and distances up to {:g} m are read: check its units",
                            size, farthest, kSmallest, kFarthest));
        }
        scene_->origin = 0.5 * (low + high);
        return Done{};
    }

    Result<Done> addInstances()
    {
        forMeshes([&](const PlacedNode& node, const GltfMesh& mesh) {
            glm::dmat4 toScene = node.toWorld;
            toScene[3] = node.toWorld * glm::dvec4(mesh.shift, 1.0) - glm::dvec4(scene_->origin, 0.0);
            for (const int part : mesh.parts) {
                Instance instance;
                instance.mesh = part;
                instance.toWorld = glm::mat4(toScene);
                instance.node = node.path;
                scene_->instances.push_back(std::move(instance));
                groupNames_.push_back(node.group);
            }
        });
        return Done{};
    }

    Result<Done> addLampsAndCameras()
    {
        for (const PlacedNode& node : nodes_) {
            PunctualLight lamp;
            Camera camera;
            glm::dvec3 at(0.0);
            if (readLamp(model_, node, lamp, at, warnings_)) {
                lamp.position = scene_->toScene(at);
                scene_->lights.push_back(std::move(lamp));
                groupNames_.push_back(node.group);
            }
            if (readCamera(model_, node, camera, at, warnings_)) {
                camera.position = scene_->toScene(at);
                scene_->cameras.push_back(std::move(camera));
            }
        }
        return Done{};
    }

    Result<Done> addMaterials()
    {
        std::vector<bool> used(model_.materials.size() + 1, false);
        for (const Mesh& mesh : scene_->meshes) used[static_cast<std::size_t>(mesh.material)] = true;
        return readMaterials(model_, checked_, folder_, used, *scene_, warnings_);
    }

    Result<Done> finish()
    {
        if (!model_.scenes.empty()) {
            const tinygltf::Scene& from = model_.scenes[static_cast<std::size_t>(std::max(model_.defaultScene, 0))];
            scene_->name = plainName(from.name);
            const double exposure = lightloomNumber(from.extras, "exposure");
            if (std::isfinite(exposure)) scene_->exposureEv = static_cast<float>(exposure);
        }
        if (model_.scenes.size() > 1) {
            warnings_.add(fmt::format("of {} scenes in the file only the default one is read", model_.scenes.size()));
        }
        scene_->warnings = warnings_.lines;
        finishScene(*scene_, groupNames_);
        return Done{};
    }

    const tinygltf::Model& model_;
    const CheckedGltf& checked_;
    const SceneFolder& folder_;
    const std::stop_token& stop_;
    GltfData data_;
    GltfWarnings warnings_;
    std::shared_ptr<Scene> scene_ = std::make_shared<Scene>();
    std::vector<PlacedNode> nodes_;
    std::vector<GltfMesh> meshes_;
    std::set<int> flattened_;
    std::vector<std::string> groupNames_; ///< of the instances, then of the lamps
};

Result<std::shared_ptr<const Scene>> readBytes(std::vector<std::uint8_t> bytes, const fs::path& home,
                                               const std::stop_token& stop)
{
    const SceneFolder folder(home);
    const Result<CheckedGltf> checked =
        checkGltf(std::move(bytes), [&](const std::string& uri, std::uint64_t most) { return folder.read(uri, most); });
    if (!checked) return checked.error();
    const Result<tinygltf::Model> model = parseModel(checked->json);
    if (!model) return model.error();
    return SceneMaker(*model, *checked, folder, stop).make();
}

} // namespace

Result<std::shared_ptr<const Scene>> readScene(std::vector<std::uint8_t> bytes, const fs::path& folder,
                                               const std::stop_token& stop)
{
    try {
        return readBytes(std::move(bytes), folder, stop);
    } catch (const std::bad_alloc&) {
        return Error{Error::Kind::outOfMemory, "there is not enough memory to read it"};
    } catch (const std::exception& e) { // out of tinygltf, nlohmann or the file system
        return bad(fmt::format("it cannot be read ({})", plainName(e.what())));
    }
}

Result<std::shared_ptr<const Scene>> readScene(const fs::path& file, const LogSink& sink, const std::stop_token& stop)
{
    const std::string name = plainName(file.filename().string());
    std::error_code ignored;
    if (fs::is_directory(file, ignored)) {
        return bad(fmt::format("{} is a folder; name the .glb or .gltf file in it", file.string()));
    }
    std::vector<std::uint8_t> bytes;
    try {
        Result<std::vector<std::uint8_t>> read = readFile(file, GltfLimits{}.fileBytes);
        if (!read) return read.error();
        bytes = *std::move(read);
    } catch (const std::bad_alloc&) {
        return Error{Error::Kind::outOfMemory, name + ": there is not enough memory to read it"};
    }
    Result<std::shared_ptr<const Scene>> scene = readScene(std::move(bytes), file.parent_path(), stop);
    if (!scene) return scene.error().in(name);
    for (const std::string& line : (*scene)->warnings) log(sink, LogLevel::warning, name + ": " + line);
    return scene;
}

} // namespace lightloom
