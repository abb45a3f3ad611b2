// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene.h"
#include <memory>
#include <optional>
#include <string_view>

namespace lightloom {

/// What a method knows about indirect light, for everyone who looks: viewport, probe, render, heatmap, tests.
/// Holds one layer per light group at baked intensity and a mix; never changes once made; any thread may read it.
/// Holds no direct light.
class IndirectField {
public:
    virtual ~IndirectField() = default;
    /// Indirect illuminance (lux per channel, never negative) on a surface at `p` (scene space) facing `n` (unit).
    /// False, and `lux` zero, where no compatible entry lies within one cell: the caller gathers instead.
    [[nodiscard]] virtual bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const = 0;
    /// Standard error of the luminance (lux) that `lookup` gives there, estimated from the spread of what it was made
    /// from; what is biased alike everywhere (blur, say) does not show in it. Nothing where there is no answer, or
    /// where the method cannot tell.
    [[nodiscard]] virtual std::optional<float> noise(glm::vec3 /*p*/, glm::vec3 /*n*/) const { return {}; }
    /// Whether a lookup traces rays (some .1 ms): whoever makes pictures then asks once for all that a pixel shows of a
    /// surface.
    [[nodiscard]] virtual bool isCostly() const { return false; }
    /// The same for the ends of a gather's rays, which ask for many places: never costly.
    [[nodiscard]] virtual bool lookupQuick(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const { return lookup(p, n, lux); }
    /// The same layers under another mix (one gain per light group; missing ones count as 1). Cheap: layers are shared.
    [[nodiscard]] virtual std::shared_ptr<const IndirectField> withMix(Mix mix) const = 0;
    [[nodiscard]] virtual std::string_view method() const = 0;
    [[nodiscard]] virtual std::size_t memoryBytes() const = 0;

    /// `lookup` where a missing answer is darkness.
    [[nodiscard]] glm::vec3 irradiance(glm::vec3 p, glm::vec3 n) const
    {
        glm::vec3 lux(0.0f);
        return lookup(p, n, lux) ? lux : glm::vec3(0.0f);
    }
};

} // namespace lightloom
