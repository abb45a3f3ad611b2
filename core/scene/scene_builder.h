// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/shapes.h"

namespace lightloom {

/// `colour` scaled so that its luminance is `value`: a warm lamp of so many candela, lux or cd/m2.
[[nodiscard]] glm::vec3 tinted(glm::vec3 colour, float value);

/// Builds a Scene in memory, piece by piece; `finish` puts groups and bounds in order. Node paths ("Room/Lamp") become
/// light group ids; `group` (a name for people) joins lamps into one group, "" leaves each lamp its own.
class SceneBuilder {
public:
    explicit SceneBuilder(const std::string& name) { scene_.name = name; }

    /// Diffuse, reflectance per channel.
    int addMaterial(const std::string& name, glm::vec3 albedo);
    /// Metal: F0 per channel; below kMirrorRoughness a mirror.
    int addMetal(const std::string& name, glm::vec3 reflectance, float roughness);
    /// Clear solid glass. `attenuation` is what it makes of white light after `distance` metres; 0: it absorbs nothing.
    int addGlass(const std::string& name, float ior, glm::vec3 attenuation = glm::vec3(1.0f), float distance = 0.0f);
    /// A thin pane for single sheets; `tint` is what a pass through its inside leaves.
    int addPane(const std::string& name, glm::vec3 tint = glm::vec3(1.0f), float ior = 1.5f);
    /// Single-sided lamp surface of `luminance` cd/m2 per channel that reflects `albedo`.
    int addEmitter(const std::string& name, glm::vec3 luminance, glm::vec3 albedo = glm::vec3(0.0f));
    int addMaterial(Material material);
    int addImage(Image image);

    /// A mesh in its place, already in scene space.
    void add(const std::string& node, Mesh mesh, int material, const std::string& group = {});
    /// Several meshes of one node, each with its own material set.
    void add(const std::string& node, std::vector<Mesh> meshes, const std::string& group = {});
    /// A mesh to be placed several times.
    int addMesh(Mesh mesh, int material);
    void place(const std::string& node, int mesh, const glm::mat4& toScene, const std::string& group = {});

    /// Isotropic, candela per channel.
    void addPoint(const std::string& node, glm::vec3 position, glm::vec3 candela, const std::string& group = {});
    /// `candela` on the axis; cones in radians from the axis, inner < outer.
    void addSpot(const std::string& node, glm::vec3 position, glm::vec3 aim, glm::vec3 candela, float innerCone,
                 float outerCone, const std::string& group = {});
    /// `lux` on a plane that faces it; `travel` need not be unit.
    void addDirectional(const std::string& node, glm::vec3 travel, glm::vec3 lux, const std::string& group = {});

    /// Looks from `position` at `target`, upright.
    void addCamera(const std::string& name, glm::vec3 position, glm::vec3 target, float yFovDeg);
    void setExposure(float ev) { scene_.exposureEv = ev; }

    /// The scene; the builder is empty afterwards.
    [[nodiscard]] Scene finish();

private:
    void addLight(PunctualLight light, const std::string& node, const std::string& group);

    Scene scene_;
    std::vector<std::string> instanceGroups_, lightGroups_;
};

} // namespace lightloom
