// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/camera_control.h"
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace lightloom {

namespace {
constexpr float kSteepest = 1.55f; ///< straight up and down have no right-hand side
constexpr float kTurn = 3.0f;      ///< radians per picture height
} // namespace

glm::vec3 CameraControl::ahead() const
{
    return {std::sin(yaw_) * std::cos(pitch_), std::sin(pitch_), -std::cos(yaw_) * std::cos(pitch_)};
}

glm::vec3 CameraControl::right() const { return {std::cos(yaw_), 0.0f, std::sin(yaw_)}; }

glm::vec3 CameraControl::through(glm::vec2 at, float aspect) const
{
    const float half = std::tan(0.5f * yFov_);
    const glm::vec2 screen = (2.0f * at - 1.0f) * half;
    return glm::normalize(ahead() + right() * (screen.x * aspect) + up() * screen.y);
}

void CameraControl::setFrom(const Camera& camera, const Bounds& bounds)
{
    bounds_ = bounds;
    eye_ = camera.position;
    yFov_ = std::clamp(camera.yFov, 0.05f, 2.8f);
    const glm::vec3 look = camera.orientation * glm::vec3(0.0f, 0.0f, -1.0f);
    yaw_ = std::atan2(look.x, -look.z);
    pitch_ = std::clamp(std::asin(std::clamp(look.y, -1.0f, 1.0f)), -kSteepest, kSteepest);
    distance_ = std::max(glm::dot(bounds.centre() - eye_, ahead()), 0.1f * bounds.diagonal());
    distance_ = std::max(distance_, 1e-6f);
}

void CameraControl::frame(const Bounds& bounds, float aspect)
{
    const float half = 0.5f * yFov_;
    const float narrow = aspect < 1.0f ? std::atan(std::tan(half) * aspect) : half;
    distance_ = std::max(0.5f * bounds.diagonal() / std::sin(narrow), 1e-6f);
    eye_ = bounds.centre() - ahead() * distance_;
}

void CameraControl::turn(glm::vec2 step)
{
    yaw_ = std::remainder(yaw_ + kTurn * step.x, 6.28318531f);
    pitch_ = std::clamp(pitch_ + kTurn * step.y, -kSteepest, kSteepest);
}

void CameraControl::orbit(glm::vec2 step)
{
    const glm::vec3 centre = pivot();
    turn(-step);
    eye_ = centre - ahead() * distance_;
}

void CameraControl::look(glm::vec2 step) { turn(step); }

void CameraControl::pan(glm::vec2 step)
{
    const float height = 2.0f * distance_ * std::tan(0.5f * yFov_);
    eye_ -= (right() * step.x + up() * step.y) * height;
}

void CameraControl::zoom(float steps, glm::vec3 toward)
{
    const float share = 1.0f - std::pow(5.0f / 6.0f, steps);
    const float least = 1e-4f * bounds_.diagonal();
    const glm::vec3 to = toward - eye_;
    // within a hand's breadth of the target go on at that pace: walls are walked through, not stuck to
    const float pace = std::max(glm::length(to), 0.05f * bounds_.diagonal());
    const float length = glm::length(to);
    if (!(length > 0.0f)) return;
    eye_ += to / length * (pace * share);
    distance_ = std::max(distance_ * (1.0f - share), std::max(least, 1e-6f));
}

void CameraControl::walk(glm::vec3 step) { eye_ += right() * step.x + glm::vec3(0, step.y, 0) + ahead() * step.z; }

void CameraControl::setPivot(glm::vec3 pivot)
{
    const glm::vec3 to = pivot - eye_;
    const float length = glm::length(to);
    if (!(length > 0.0f)) return;
    distance_ = length;
    yaw_ = std::atan2(to.x, -to.z);
    pitch_ = std::clamp(std::asin(std::clamp(to.y / length, -1.0f, 1.0f)), -kSteepest, kSteepest);
}

glm::mat4 CameraControl::view() const { return glm::lookAt(eye_, eye_ + ahead(), glm::vec3(0.0f, 1.0f, 0.0f)); }

glm::vec2 CameraControl::planes() const
{
    // as near as the scene allows: from outside a room the box decides, from inside a share of its size
    const float diagonal = std::max(bounds_.diagonal(), 1e-6f);
    const float away = glm::length(glm::max(glm::max(bounds_.low - eye_, eye_ - bounds_.high), glm::vec3(0.0f)));
    const float far = away + 1.1f * diagonal;
    const float near = std::max(0.9f * away, 5e-4f * diagonal);
    return {std::min(near, 0.5f * far), far};
}

glm::mat4 CameraControl::projection(float aspect) const
{
    const glm::vec2 depth = planes();
    return glm::perspective(yFov_, aspect, depth.x, depth.y);
}

Camera CameraControl::camera() const
{
    Camera camera;
    camera.name = "view";
    camera.position = eye_;
    camera.orientation = glm::quat_cast(glm::transpose(glm::mat3(view())));
    camera.yFov = yFov_;
    camera.nearPlane = planes().x;
    return camera;
}

} // namespace lightloom
