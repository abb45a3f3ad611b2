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
        if (block_.segments) listSegments();
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

void PhotonWave::listSegments()
{
    for (std::size_t ray = 0; ray < count_; ++ray) {
        const PhotonPath& photon = photons_[places_[ray]];
        if (!photon.isIndirect()) continue;
        const Rays8& rays = rays_[ray / kGroup];
        const Met8& met = met_[ray / kGroup];
        const std::size_t i = ray % kGroup;
        const bool isEndless = met.triangle[i] == Met8::kNothing;
        block_.segments->push_back({{rays.origin[0][i], rays.origin[1][i], rays.origin[2][i]},
                                    rays.travelOf(i),
                                    photon.flux(),
                                    isEndless ? PhotonSegment::kEndless : met.distance[i],
                                    isEndless ? PhotonSegment::kNowhere : met.triangle[i]});
    }
}

/// Rays that go on move up, and never past one that is still to be looked at; those that end are overwritten.
void PhotonWave::meetAll()
{
    std::array<std::uint8_t, kWidth> freed;
    std::size_t freedCount = 0;
    const std::size_t count = count_;
    count_ = 0;
    for (std::size_t ray = 0; ray < count; ++ray) {
        const std::uint8_t place = places_[ray];
        const bool lives = meet(ray, photons_[place]);
        places_[count_] = freed[freedCount] = place;
        count_ += lives ? 1 : 0;
        freedCount += lives ? 0 : 1;
    }
    for (std::size_t i = 0; i < freedCount; ++i) {
        photons_[freed[i]].close(block_.ledger);
        startIn(freed[i]);
    }
}

inline bool PhotonWave::meet(std::size_t ray, PhotonPath& photon)
{
    const Rays8& rays = rays_[ray / kGroup];
    const Met8& met = met_[ray / kGroup];
    const std::size_t i = ray % kGroup;
    if (met.triangle[i] == Met8::kNothing) {
        photon.escape();
        return false;
    }
    const InstanceLook& look = block_.rays.look(met.instance[i]);
    if (!photon.meetsMatte(look)) {
        Departure away;
        const bool lives = photon.meet(block_, block_.rays.hitOf(rays, met, i), rays.travelOf(i), away);
        if (lives) put(away, count_);
        return lives;
    }
    MatteDeparture away;
    const SceneTriangle& t = block_.rays.triangle(met.triangle[i]);
    const bool lives = photon.meetMatte(block_, look, t, {met.u[i], met.v[i]}, rays.travelOf(i), away);
    Rays8& next = rays_[count_ / kGroup];
    for (int axis = 0; axis < 3; ++axis) next.origin[axis][count_ % kGroup] = away.origin[axis];
    draws_.ask(count_, {away.side[0], away.side[1], away.side[2]}, away.aim);
    return lives;
}

} // namespace lightloom
