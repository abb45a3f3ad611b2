// SPDX-License-Identifier: Apache-2.0
#include "core/octree/detail_fit.h"
#include "core/base/units.h"
#include "core/octree/detail_level.h"
#include "core/octree/entry_screens.h"
#include "core/octree/layer_fit.h"
#include "core/octree/octree_blend.h"
#include "core/octree/octree_build.h"
#include <algorithm>
#include <atomic>
#include <cmath>

namespace lightloom {
namespace {

constexpr double kApart = 3.0;      ///< standard errors that a neighbour has to differ by
constexpr double kFewest = 1.0;     ///< photons that a child's kernel has to expect
constexpr double kLeastShare = 0.1; ///< of a variance that a difference always has
constexpr double kMostGain = 25.0;  ///< of one entry: the evidence of few does not speak for all around

/// Sums over photons, of luminous flux and of its square.
struct FluxSums {
    double flux = 0.0, squares = 0.0;
    void add(const Photon& photon)
    {
        const auto f = static_cast<double>(luminance(photon.flux));
        flux += f, squares += f * f;
    }
    [[nodiscard]] double perPhoton(double fallback) const { return flux > 0.0 ? squares / flux : fallback; }
};

class DetailFit {
public:
    DetailFit(const DetailJob& job, BakeControl& control) : job_(job), control_(control)
    {
        FluxSums all;
        for (std::uint32_t i = 0; i < job.map.size(); ++i) all.add(job.map.photon(i));
        fluxPerPhoton_ = all.perPhoton(0.0);
    }

    DetailResult run()
    {
        LampDetail unjudged;
        std::vector<DetailCandidates> levels;
        for (int l = 0; l < job_.params.octreeDetail; ++l) {
            const OctreeGeometry& above = l == 0 ? job_.base : *unjudged.back().geometry;
            DetailCandidates level;
            level.parents = candidates(above, l == 0 ? job_.layer : *unjudged.back().layer);
            if (control_.isStopped()) return {};
            if (level.parents.empty()) break;
            const CellLattice lattice{job_.base.lowest, job_.base.rootSize, above.depth + 1};
            const auto leaves =
                buildLeaves(lattice, {level.parents, above.depth}, job_.reach, control_.workers(), control_.stop());
            if (!leaves) return {};
            const bool isScreened = job_.params.gatherScreens == Switch::on;
            if (isScreened && !findScreens(*leaves, job_.screens, control_.workers(), control_.stop())) return {};
            level.geometry = leaves;
            if (!fit(level, unjudged)) return {};
            darken(level, control_.stop());
            judge(level, control_.stop());
            if (control_.isStopped()) return {};
            unjudged.push_back({level.geometry, level.layer});
            levels.push_back(std::move(level));
        }
        return {std::make_shared<const LampDetail>(splitLeaves(levels)), fits_, degenerate_};
    }

private:
    std::vector<std::uint64_t> candidates(const OctreeGeometry& geometry, const VdlLayer& layer)
    {
        const double radius = static_cast<double>(kDetailRadius * 0.5f * geometry.cellSize());
        const double leastLux = kFewest * fluxPerPhoton_ / (static_cast<double>(kPi) * radius * radius);
        std::vector<char> is(geometry.cells.size(), 0);
        forBlocks(is.size(), [&](std::size_t i) { is[i] = isCandidate(geometry, layer, i, leastLux); });
        std::vector<std::uint64_t> cells;
        for (std::size_t i = 0; i < is.size(); ++i) {
            if (is[i]) cells.push_back(geometry.cells[i]);
        }
        return cells;
    }

    /// Bright enough for the photons of smaller kernels, and beside a leaf whose light differs by more than noise.
    static bool isCandidate(const OctreeGeometry& geometry, const VdlLayer& layer, std::size_t leaf, double leastLux)
    {
        const glm::ivec3 cell(mortonCell(geometry.cells[leaf]));
        for (std::uint32_t e = geometry.firstEntry[leaf]; e < geometry.firstEntry[leaf + 1]; ++e) {
            const auto lux = static_cast<double>(luminance(layer.scalar[e]));
            if (!(lux > leastLux)) continue;
            const double apart = kApart * static_cast<double>(layer.noise[e]);
            for (int side = 0; side < 6; ++side) {
                glm::ivec3 next = cell;
                next[side >> 1] += side & 1 ? 1 : -1;
                const std::int64_t other = geometry.leafAt(next);
                const std::int64_t entry = other < 0 ? -1 : entryFor(geometry, other, geometry.entries[e].normal);
                if (entry < 0) continue;
                const auto there = static_cast<double>(luminance(layer.scalar[static_cast<std::size_t>(entry)]));
                if (std::abs(there - lux) > apart) return true;
            }
        }
        return false;
    }

    /// Fits all children and sees what each says of the levels `above`. False: stopped.
    bool fit(DetailCandidates& level, const LampDetail& above)
    {
        const OctreeGeometry& geometry = *level.geometry;
        level.layer = emptyLayer(geometry, job_.layer.group, job_.params);
        level.gain.resize(geometry.entries.size());
        level.few.resize(geometry.entries.size());
        const LayerFit fit(geometry, job_.map, job_.area, job_.params, *level.layer);
        fits_ += geometry.entries.size();
        return forBlocks(geometry.entries.size(), [&](std::size_t e) {
            thread_local FitScratch scratch;
            if (fit.fit(static_cast<std::uint32_t>(e), scratch)) ++degenerate_;
            level.gain[e] = static_cast<float>(gain(geometry.entries[e], scratch, above));
            if (scratch.isFew) level.few[e] = fewOf(scratch.near, scratch.density);
        });
    }

    static DetailCandidates::Few fewOf(const Density& near, const Density& wide)
    {
        const auto lux = [](const Density& d) { return static_cast<double>(luminance(glm::vec3(d.lux))); };
        const double perPhoton = wide.noise * wide.noise / wide.perFlux * near.perFlux / lux(wide); // lux of one, near
        if (!(perPhoton > 0.0 && std::isfinite(perPhoton))) return {};
        return {static_cast<float>(lux(near) / perPhoton), static_cast<float>(lux(wide) / perPhoton)};
    }

    /// See DetailCandidates::gain. If the light is what the levels above say, a child's estimate and theirs differ by
    /// noise, whose variance is the child's less theirs: kernels are nested, or nearly.
    [[nodiscard]] double gain(const OctreeEntry& entry, const FitScratch& s, const LampDetail& above) const
    {
        const Density& density = s.isFew ? s.near : s.density;
        const Answers coarse = answersAround(job_.base, entry.centroid, entry.normal);
        if (!(coarse.sum > 0.0f) || !(density.perFlux > 0.0)) return 0.0;
        const auto blended = [&](const auto& valueOf) {
            const float own = coarse.mean([&](std::size_t e) { return valueOf(job_.layer, e); }) / coarse.sum;
            return static_cast<double>(refined(own, job_.base, above, entry.centroid, entry.normal, valueOf));
        };
        const double expected =
            blended([](const VdlLayer& layer, std::size_t e) { return luminance(layer.scalar[e]); });
        const double noise = blended([](const VdlLayer& layer, std::size_t e) { return layer.noise[e]; });
        FluxSums sums;
        for (const std::uint32_t number : s.gathered.photons) sums.add(job_.map.photon(number));
        const double asMean = sums.squares * density.perFlux * density.perFlux;
        const double plane = asMean > 0.0 && !s.isFew ? std::max(1.0, density.noise * density.noise / asMean) : 1.0;
        // of the light that is expected: chance that gave a kernel too few photons also gives it too little noise
        const double variance = expected * sums.perPhoton(fluxPerPhoton_) * density.perFlux * plane;
        if (!(variance > 0.0)) return 0.0;
        const double apart = static_cast<double>(luminance(glm::vec3(density.lux))) - expected;
        const double explained = std::max(variance - noise * noise, kLeastShare * variance);
        return std::min((apart * apart - explained) / variance, kMostGain);
    }

    template<class Use>
    bool forBlocks(std::size_t count, const Use& use)
    {
        constexpr std::size_t kBlock = 64;
        return control_.forBlocks((count + kBlock - 1) / kBlock, [&](std::size_t block) {
            for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
                if (control_.isStopped()) return;
                use(i);
            }
        });
    }

    const DetailJob& job_;
    BakeControl& control_;
    double fluxPerPhoton_ = 0.0; ///< mean over the group, weighted by flux
    std::atomic<std::uint64_t> fits_ = 0, degenerate_ = 0;
};

} // namespace

DetailResult fitDetail(const DetailJob& job, BakeControl& control) { return DetailFit(job, control).run(); }

} // namespace lightloom
