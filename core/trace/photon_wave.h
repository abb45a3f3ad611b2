// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/cosine_draws.h"
#include "core/trace/photon_path.h"
#include <array>

namespace lightloom {

/// Photons of a block, many under way at a time; where one ends the next starts, so that directions are drawn and rays
/// traced eight at once as long as there are as many. Each step does one thing for all: the processor then foresees its
/// branches, and triangles come from memory while other rays are traced.
class PhotonWave {
public:
    /// Photons `number` to `end`, without it.
    PhotonWave(PhotonBlock& block, std::uint64_t number, std::uint64_t end) : block_(block), next_(number), end_(end) {}
    void trace();

private:
    static constexpr std::size_t kWidth = CosineDraws::kCount, kGroup = Rays8::kCount;

    void startIn(std::uint8_t place);
    void put(const Departure& away, std::size_t ray)
    {
        Rays8& rays = rays_[ray / kGroup];
        for (int axis = 0; axis < 3; ++axis) rays.origin[axis][ray % kGroup] = away.ray.origin[axis];
        draws_.ask(ray, away.side, away.aim);
        if (!away.isUnaimed) aimed_[aimedCount_++] = {ray, away.ray.travel};
    }
    void aim();
    void listSegments();
    void meetAll();
    bool meet(std::size_t ray, PhotonPath& photon);

    PhotonBlock& block_;
    std::uint64_t next_, end_;
    std::size_t count_ = 0;                   // of rays: those of one step lie together
    std::array<std::uint8_t, kWidth> places_; // where the photon of each ray is kept
    std::array<PhotonPath, kWidth> photons_;
    std::array<Rays8, kWidth / kGroup> rays_;
    std::array<Met8, kWidth / kGroup> met_;
    CosineDraws draws_;
    struct Aimed {
        std::size_t ray;
        glm::vec3 travel;
    };
    std::array<Aimed, kWidth> aimed_; // rays that are not drawn
    std::size_t aimedCount_ = 0;
};

} // namespace lightloom
