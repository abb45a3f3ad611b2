// SPDX-License-Identifier: Apache-2.0
#include "core/trace/photon_wave.h"
#include <algorithm>

namespace lightloom {

void PhotonWave::trace()
{
    for (std::size_t place = 0; place < kWidth; ++place) startIn(static_cast<std::uint8_t>(place));
    while (count_ > 0) {
        aim();
        block_.rayCount += count_;
        for (std::size_t first = 0; first < count_; first += kGroup)
            block_.rays.intersect(rays_[first / kGroup], std::min(kGroup, count_ - first), met_[first / kGroup]);
        block_.makeRoom(count_);
        meetAll();
    }
}

void PhotonWave::startIn(std::uint8_t place)
{
    while (next_ < end_) {
        Departure away;
        if (!photons_[place].start(block_, next_++, away)) continue;
        put(away, count_);
        places_[count_++] = place;
        return;
    }
}

void PhotonWave::aim()
{
    draws_.draw(count_);
    for (std::size_t first = 0; first < count_; first += kGroup) {
        for (int axis = 0; axis < 3; ++axis)
            std::copy_n(draws_.coordinate(axis) + first, kGroup, rays_[first / kGroup].travel[axis]);
    }
    for (std::size_t i = 0; i < aimedCount_; ++i) {
        const Aimed& aimed = aimed_[i];
        for (int axis = 0; axis < 3; ++axis)
            rays_[aimed.ray / kGroup].travel[axis][aimed.ray % kGroup] = aimed.travel[axis];
    }
    aimedCount_ = 0;
}

/// Rays that go on move up, and never past one that is still to be looked at.
void PhotonWave::meetAll()
{
    std::array<std::uint8_t, kWidth> freed;
    std::size_t freedCount = 0;
    const std::size_t count = count_;
    count_ = 0;
    for (std::size_t ray = 0; ray < count; ++ray) {
        const std::uint8_t place = places_[ray];
        const Met8& met = met_[ray / kGroup];
        bool lives = false;
        if (met.triangle[ray % kGroup] == Met8::kNothing) {
            photons_[place].escape();
        } else {
            const Rays8& rays = rays_[ray / kGroup];
            const Hit hit = block_.rays.hitOf(rays, met, ray % kGroup);
            Departure away;
            lives = photons_[place].meet(block_, hit, rays.travelOf(ray % kGroup), away);
            if (lives | away.isUnaimed) put(away, count_); // if it does not live, the next takes its place
        }
        places_[count_] = freed[freedCount] = place;
        count_ += lives ? 1 : 0;
        freedCount += lives ? 0 : 1;
    }
    for (std::size_t i = 0; i < freedCount; ++i) {
        photons_[freed[i]].close(block_.ledger);
        startIn(freed[i]);
    }
}

} // namespace lightloom
