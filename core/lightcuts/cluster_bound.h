// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/sampling.h"
#include "core/lightcuts/light_tree.h"

namespace lightloom {

/// Upper bounds of what clusters of lights can send to one receiver, whatever hides them. Without trigonometry: angles
/// are compared by their cosines. No light's `discTransfer` is larger, in float as well: bounds and cones are a little
/// wider than rounding needs.
class ClusterBound {
public:
    ClusterBound(const Receiver& at, const NearRange& near)
        : at_(at), frame_(at.normal), outerSquared_(near.outer * near.outer), share_(near.isEmpty() ? 1.0f : 0.0f)
    {
    }

    /// At least `discTransfer` of each light of the cluster (lux per lumen). 0: none of it can be seen from here.
    [[nodiscard]] float transfer(const LightNode& node) const
    {
        if (!(node.low.x <= node.high.x)) return 0.0f; // all are dark
        const glm::vec3 low = node.low - at_.position, high = node.high - at_.position;
        const float here = highest(at_.normal, low, high);
        if (!(here > 0.0f)) return 0.0f;
        const glm::vec3 gap = glm::max(glm::max(low, -high), glm::vec3(0.0f));
        const float nearest = gap.x * gap.x + gap.y * gap.y + gap.z * gap.z;
        const float there = cosineAtLights(node, low, high, nearest);
        if (!(there > 0.0f)) return 0.0f;
        const float aside = square(leastAlong(frame_.tangent, low, high)) + //
                            square(leastAlong(frame_.bitangent, low, high));
        const float cosine = cosineWithin(here, nearest, aside);
        // within `near` a disc's share grows faster than the square of its distance falls (NearRange: outer is at most
        // twice inner), so that it is largest at the border
        return kWider * cosine * there / (kPi * glm::max(nearest, outerSquared_) + share_ * node.leastArea);
    }

    /// Surely all of the cluster lies before the receiver and faces it: then what it sends hardly depends on which of
    /// its lights one looks at.
    [[nodiscard]] bool isInView(const LightNode& node) const
    {
        const glm::vec3 low = node.low - at_.position, high = node.high - at_.position;
        if (!(-highest(-at_.normal, low, high) > 0.0f)) return false;
        const float along = -highest(node.axis, low, high); // least, of the way to the receiver on the cone's axis
        if (!(along > 0.0f) || !(node.cosine > 0.0f)) return false;
        const glm::vec3 far = glm::max(glm::abs(low), glm::abs(high));
        return square(along) > (1.0f - square(node.cosine)) * glm::dot(far, far);
    }

private:
    static float square(float v) { return v * v; }
    /// Largest dot product of `axis` with a point of the box.
    static float highest(glm::vec3 axis, glm::vec3 low, glm::vec3 high)
    {
        return axis.x * (axis.x > 0.0f ? high.x : low.x) + axis.y * (axis.y > 0.0f ? high.y : low.y) +
               axis.z * (axis.z > 0.0f ? high.z : low.z);
    }
    /// Smallest distance along `axis` from the origin to the box.
    static float leastAlong(glm::vec3 axis, glm::vec3 low, glm::vec3 high)
    {
        return glm::max(0.0f, glm::max(-highest(axis, low, high), -highest(-axis, low, high)));
    }
    /// Largest cosine to an axis of points at most `along` it (positive), at least `aside` (squared) beside it and at
    /// least `nearest` (squared) away.
    static float cosineWithin(float along, float nearest, float aside)
    {
        const float squared = glm::max(nearest, along * along + aside);
        return squared > along * along ? along / std::sqrt(squared) : 1.0f;
    }
    /// Largest cosine with which a light of the cluster can send to the receiver.
    static float cosineAtLights(const LightNode& node, glm::vec3 low, glm::vec3 high, float nearest)
    {
        const float along = highest(-node.axis, low, high); // of the way to the receiver, on the cone's axis
        float towards = 0.0f;                               // largest cosine between the axis and the way
        if (along > 0.0f) {
            const glm::vec3 centre = 0.5f * (low + high), half = 0.5f * (high - low);
            const float beside = glm::length(centre - glm::dot(centre, node.axis) * node.axis) - glm::length(half);
            towards = cosineWithin(along, nearest, square(glm::max(0.0f, beside)));
        } else {
            const glm::vec3 far = glm::max(glm::abs(low), glm::abs(high));
            towards = along / glm::max(glm::length(far), 1e-30f);
        }
        if (towards >= node.cosine) return 1.0f;
        // cos(a - b) of the angle to the axis and that of the cone
        const float sines = glm::max(0.0f, 1.0f - towards * towards) * glm::max(0.0f, 1.0f - node.cosine * node.cosine);
        return glm::min(1.0f, towards * node.cosine + std::sqrt(sines) + kRounding);
    }

    static constexpr float kRounding = 0x1p-20f, kWider = 1.0f + 0x1p-20f;
    Receiver at_;
    Frame frame_;
    float outerSquared_, share_; // of the area that surely counts
};

} // namespace lightloom
