// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/gpu_layout.h"
#include "core/ivg/ivg_solver.h"
#include "core/octree/octree_solver.h"
#include "widgets/gl/renderer.h"
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLVersionFunctionsFactory>
#include <glm/gtc/matrix_transform.hpp>

namespace lightloom {

/// A current OpenGL 3.3 context without a window, and a target to draw into.
class GlFixture {
public:
    /// False: there is none here.
    bool start(glm::ivec2 size)
    {
        surface_.create();
        if (!context_.create() || !context_.makeCurrent(&surface_)) return false;
        gl = QOpenGLVersionFunctionsFactory::get<Gl>(&context_);
        if (gl == nullptr || !gl->initializeOpenGLFunctions()) return false;
        colour_ = makeTexture2D(*gl, GL_RGBA8, size, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
        const GLuint id = colour_.id();
        Result<GlFramebuffer> made = makeFramebuffer(*gl, {&id, 1}, 0);
        if (!made) return false;
        target_ = std::move(*made);
        return true;
    }
    [[nodiscard]] GLuint target() const { return target_.id(); }
    Gl* gl = nullptr;

private:
    QOffscreenSurface surface_;
    QOpenGLContext context_;
    GlTexture colour_;
    GlFramebuffer target_;
};

/// What a solver ends with; null if it failed.
template<class Field, class SolverOfIt>
std::shared_ptr<const Field> bakeField(const std::shared_ptr<const Scene>& scene, const BakeParams& params)
{
    std::shared_ptr<const Field> last;
    Workers workers;
    BakeProducts products;
    BakeControl control(workers, {[&](Snapshot s) { last = std::dynamic_pointer_cast<const Field>(s.field); }, {}});
    BakeJob job;
    job.scene = scene;
    job.params = params;
    SolverOfIt solver;
    return solver.bake(job, products, control) ? last : nullptr;
}

inline std::shared_ptr<const LightOctree> bakeOctree(const std::shared_ptr<const Scene>& scene,
                                                     const BakeParams& params)
{
    return bakeField<LightOctree, OctreeSolver>(scene, params);
}

inline std::shared_ptr<const IrradianceGrid> bakeGrid(const std::shared_ptr<const Scene>& scene,
                                                      const BakeParams& params)
{
    return bakeField<IrradianceGrid, IvgSolver>(scene, params);
}

/// The scene's camera `index` for pictures of `size`.
inline FrameView viewOf(const Scene& scene, std::size_t index, glm::ivec2 size)
{
    const Camera& camera = scene.cameras[index];
    FrameView frame;
    frame.eye = camera.position;
    frame.view = glm::inverse(glm::translate(glm::mat4(1.0f), camera.position) * glm::mat4_cast(camera.orientation));
    const float aspect = static_cast<float>(size.x) / static_cast<float>(size.y);
    frame.projection = glm::perspective(camera.yFov, aspect, camera.nearPlane, 10.0f * scene.bounds.diagonal());
    frame.exposureEv = scene.exposureEv.value_or(8.0f);
    return frame;
}

} // namespace lightloom
