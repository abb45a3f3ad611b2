// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/units.h"
#include "core/base/wide_vectors.h"
#include "core/trace/medium.h"
#include "core/trace/photon_segments.h"
#include <cstring>
#include <limits>

namespace lightloom {

/// A block of photons that one worker traces, and what comes of it. Blocks are joined in their order.
struct PhotonBlock {
    const RayScene& rays;
    const LightSampler& lights;
    const PhotonJob& job;
    std::uint64_t streamKey;     ///< Rng::streamKey of the group
    float perPhoton;             ///< one over the number shot
    RawVector<Photon> photons{}; ///< the first `stored` count
    std::size_t stored = 0;
    std::uint64_t rayCount = 0, caustic = 0, cutOff = 0;
    Ledger ledger{};
    RawVector<PhotonSegment>* segments = nullptr; ///< where indirect segments go, if anyone asks for them

    /// Before so many are stored. One place more: whole registers are written.
    void makeRoom(std::size_t more)
    {
        if (photons.size() <= stored + more) photons.resize(2 * (stored + more) + 1);
    }
};

/// How a photon leaves a lamp or a surface. Most directions come from a cosine, and those are left to be drawn
/// together.
struct Departure {
    Ray ray;
    bool isUnaimed = false; ///< ray.travel is to be drawn from the cosine around `side` with `aim`
    glm::vec3 side{0.0f, 0.0f, 1.0f};
    glm::vec2 aim{0.0f};
};

/// How it leaves a matte surface: a direction is to be drawn from the cosine around `side` with `aim`.
struct MatteDeparture {
    Floats4 origin, side; ///< x, y, z
    glm::vec2 aim;
};

/// One photon under way. Where a photon is stored and whether it goes on is as good as random: the usual way is without
/// branches that depend on it.
class PhotonPath {
public:
    /// False: no photon leaves the lamps under this number.
    bool start(const PhotonBlock& block, std::uint64_t number, Departure& away)
    {
        rng_ = Rng(block.streamKey, number);
        EmittedPhoton photon;
        if (!block.lights.launch(block.job.group, rng_, photon)) return false;
        first_ = flux_ = photon.flux * block.perPhoton;
        away = {{photon.position, photon.travel}, photon.isUnaimed, photon.side, photon.aim};
        medium_ = Medium();
        bounce_ = 0;
        hasDiffused_ = hasMirrored_ = false;
        end_ = &Ledger::absorbed;
        return true;
    }

    void escape() { end_ = &Ledger::escaped; }

    /// On its way after its first surface, or after a mirror or glass: light that nobody computes exactly elsewhere.
    [[nodiscard]] bool isIndirect() const { return bounce_ > 0; }
    [[nodiscard]] glm::vec3 flux() const { return flux_; } ///< lumen

    /// Takes the photon from a hit onward. False: it ended here. The block has room for it.
    bool meet(PhotonBlock& block, const Hit& hit, glm::vec3 travel, Departure& away)
    {
        const InstanceLook& look = block.rays.look(hit.instance);
        if (!meetsMatte(look)) return meetAny(block, hit, travel, away);
        MatteDeparture matte;
        const SceneTriangle& t = block.rays.triangle(hit.triangle);
        const bool lives = meetMatte(block, look, t, hit.barycentric, travel, matte);
        const Floats4 &p = matte.origin, &n = matte.side;
        away = {{{p[0], p[1], p[2]}, travel}, true, {n[0], n[1], n[2]}, matte.aim};
        return lives;
    }

    /// Whether a surface is diffuse and nothing else, as most are, and air before it.
    [[nodiscard]] bool meetsMatte(const InstanceLook& look) const { return look.isMatte && medium_.isAir(); }

    /// `meet` there.
    [[gnu::always_inline]] bool meetMatte(PhotonBlock& block, const InstanceLook& look, const SceneTriangle& t,
                                          glm::vec2 b, glm::vec3 travel, MatteDeparture& away)
    {
        const auto of = [](const glm::vec3& v) -> const auto& { return lanesOf<Floats4>(&v.x, 0); };
        const Floats4 position = of(t.a) * (1.0f - b.x - b.y) + of(t.b) * b.x + of(t.c) * b.y;
        const float along = glm::dot(t.normal, travel);
        const bool isFront = along < 0.0f;
        Ints4 normalBits = lanesOf<Ints4>(&t.normal.x, 0);
        normalBits ^= isFront ? 0 : std::numeric_limits<std::int32_t>::min(); // changes signs
        Floats4 normal;
        std::memcpy(&normal, &normalBits, sizeof normal);
        const Floats4 back{-travel.x, -travel.y, -travel.z, 0.0f}, flux = of(flux_);

        Photon& photon = block.photons[block.stored];
        const auto set = [](glm::vec3& v, const Floats4& value) { lanesOf<Floats4>(&v.x, 0) = value; };
        set(photon.position, position), set(photon.toLight, back), set(photon.flux, flux), set(photon.normal, normal);
        const auto [u1, u2] = rng_.uniformPair();
        away = {position + normal * block.rays.offset(), normal, {u1, u2}};
        if (!arrive(block)) return false;

        const bool isLit = isFront | (along > 0.0f); // not so for triangles without area
        const bool lives = isLit & (rng_.uniform() < look.survival);
        flux_ *= look.kept * static_cast<float>(lives); // a choice would become a branch
        hasDiffused_ = true;
        ++bounce_;
        return lives;
    }

    /// After the photon ended: what is left of it goes where it ended; what it lost on its way was absorbed (or, where
    /// a weight was above 1 in a channel, given back from what other paths lost: the sum stays exact).
    void close(Ledger& ledger) const
    {
        ledger.emitted += glm::dvec3(first_);
        ledger.absorbed += glm::dvec3(first_) - glm::dvec3(flux_);
        ledger.*end_ += glm::dvec3(flux_);
    }

private:
    [[gnu::noinline]] bool meetAny(PhotonBlock& block, const Hit& hit, glm::vec3 travel, Departure& away)
    {
        const Surface surface = surfaceAt(block.rays, hit);
        if (medium_.absorbs(hit, surface) && !thin(medium_.transmittance(hit, surface), 1.0f, rng_.uniform()))
            return false;
        const glm::vec3 normal = hit.facing(), back = -travel;
        block.photons[block.stored] = {hit.position, back, flux_, normal};
        if (!arrive(block)) return false;
        const auto [u1, u2] = rng_.uniformPair();
        const auto [u3, survive] = rng_.uniformPair();
        Scatter next;
        if (!scatter(surface, normal, back, {u1, u2, u3}, next) ||
            !thin(next.weight, clearChance(surface, bounce_), survive)) {
            flux_ = glm::vec3(0.0f);
            return false;
        }
        (next.isSpecular ? hasMirrored_ : hasDiffused_) = true;
        medium_.cross(hit, surface, next);
        away = {{block.rays.leave(hit.position, next.side(normal)), next.away}};
        ++bounce_;
        return true;
    }

    /// After what would be stored was written behind the block's photons. False: the path is as long as it may be.
    bool arrive(PhotonBlock& block)
    {
        // the first diffuse hit is direct light, computed exactly elsewhere, unless a mirror or glass was on the way
        const bool isStored = bounce_ > 0;
        block.stored += isStored ? 1 : 0;
        block.caustic += isStored & hasMirrored_ & !hasDiffused_ ? 1 : 0;
        if (bounce_ + 1 < block.job.pathDepth) return true;
        ++block.cutOff;
        end_ = &Ledger::terminated;
        return false;
    }

    /// Roulette: the photon lives with the chance of the largest channel of `weight`, at most `most`. False: it ended.
    bool thin(glm::vec3 weight, float most, float survive)
    {
        const float chance = glm::min(most, maxChannel(weight));
        const bool lives = survive < chance;
        flux_ *= lives ? weight / chance : glm::vec3(0.0f);
        return lives;
    }

    Rng rng_{0, 0};
    glm::vec3 first_{0.0f}, flux_{0.0f}; ///< lumen, at the lamp and now
    Medium medium_;
    int bounce_ = 0;
    bool hasDiffused_ = false, hasMirrored_ = false; ///< what the path has met
    glm::dvec3 Ledger::*end_ = &Ledger::absorbed;
};

} // namespace lightloom
