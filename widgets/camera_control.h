// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/scene/scene.h"
#include <glm/glm.hpp>

namespace lightloom {

/// A camera that is moved by hand: it looks from `distance` away at a pivot, always upright (+Y). Scene space, metres,
/// radians. Screen steps are fractions of the picture's height, x to the right, y upwards.
class CameraControl {
public:
    /// Takes over a scene's camera; the pivot lies where it looks, at the depth of the scene's middle. Roll is lost.
    void setFrom(const Camera& camera, const Bounds& bounds);
    /// Backs off until all of `bounds` is in the picture; keeps the direction.
    void frame(const Bounds& bounds, float aspect);
    void setBounds(const Bounds& bounds) { bounds_ = bounds; }

    void orbit(glm::vec2 step);               ///< turns about the pivot
    void pan(glm::vec2 step);                 ///< moves pivot and eye with what is at the pivot's depth
    void zoom(float steps, glm::vec3 toward); ///< a step nears `toward` by a sixth; the eye may pass through it
    void look(glm::vec2 step);                ///< turns about the eye
    void walk(glm::vec3 step);                ///< metres to the right, up and ahead
    void shift(glm::vec3 by) { eye_ += by; }  ///< the scene's frame moved the other way
    void setPivot(glm::vec3 pivot);           ///< the eye stays and turns to it

    [[nodiscard]] glm::vec3 eye() const { return eye_; }
    [[nodiscard]] glm::vec3 pivot() const { return eye_ + ahead() * distance_; }
    [[nodiscard]] glm::vec3 ahead() const;
    [[nodiscard]] glm::vec3 right() const;
    [[nodiscard]] glm::vec3 up() const { return glm::cross(right(), ahead()); }
    /// Unit direction through a point of the picture, 0 to 1 from the lower left.
    [[nodiscard]] glm::vec3 through(glm::vec2 at, float aspect) const;
    [[nodiscard]] float distance() const { return distance_; }
    [[nodiscard]] glm::mat4 view() const;
    [[nodiscard]] glm::mat4 projection(float aspect) const; ///< planes follow the scene's bound
    [[nodiscard]] Camera camera() const;                    ///< the same for whoever traces rays through it

private:
    void turn(glm::vec2 step);
    [[nodiscard]] glm::vec2 planes() const; ///< near, far

    Bounds bounds_;
    glm::vec3 eye_{0.0f, 0.0f, 3.0f};
    float yaw_ = 0.0f, pitch_ = 0.0f; ///< 0, 0 looks along -Z
    float distance_ = 3.0f, yFov_ = 0.8f;
};

} // namespace lightloom
