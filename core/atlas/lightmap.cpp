// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/lightmap.h"
#include "core/trace/direct_light.h"
#include <atomic>

namespace lightloom {
namespace {

constexpr std::size_t kBlockTexels = 512;
constexpr std::uint64_t kStream = hashName("lightmap");

/// Calls `use` with the index of each of the eight neighbours of texel `i` that has the same owner.
template<class Use>
void eachNeighbour(const Atlas& atlas, std::size_t i, const Use& use)
{
    const auto size = static_cast<std::ptrdiff_t>(atlas.size);
    const auto x = static_cast<std::ptrdiff_t>(i) % size, y = static_cast<std::ptrdiff_t>(i) / size;
    for (std::ptrdiff_t v = std::max<std::ptrdiff_t>(0, y - 1); v <= std::min(size - 1, y + 1); ++v) {
        for (std::ptrdiff_t u = std::max<std::ptrdiff_t>(0, x - 1); u <= std::min(size - 1, x + 1); ++u) {
            const auto n = static_cast<std::size_t>(v * size + u);
            if (n != i && atlas.owners[n] == atlas.owners[i]) use(n);
        }
    }
}

} // namespace

void dilate(const Atlas& atlas, std::vector<std::uint8_t> known, FloatImage& image)
{
    const auto isOpen = [&](std::size_t i) { return !known[i] && atlas.owners[i] >= 0; };
    std::vector<std::size_t> ring;
    std::vector<std::uint8_t> isListed(known.size(), 0);
    const auto list = [&](std::vector<std::size_t>& into, std::size_t i) {
        if (!isOpen(i) || isListed[i]) return;
        isListed[i] = 1;
        into.push_back(i);
    };
    for (std::size_t i = 0; i < known.size(); ++i) {
        bool touchesKnown = false;
        if (isOpen(i)) eachNeighbour(atlas, i, [&](std::size_t n) { touchesKnown = touchesKnown || known[n]; });
        if (touchesKnown) list(ring, i);
    }
    while (!ring.empty()) {
        for (const std::size_t i : ring) {
            glm::vec3 sum(0.0f);
            int count = 0;
            eachNeighbour(atlas, i, [&](std::size_t n) {
                if (known[n]) sum += image.pixels[n], ++count;
            });
            image.pixels[i] = sum / static_cast<float>(count);
        }
        for (const std::size_t i : ring) known[i] = 1;
        std::vector<std::size_t> next;
        for (const std::size_t i : ring) eachNeighbour(atlas, i, [&](std::size_t n) { list(next, n); });
        ring = std::move(next);
    }
}

std::optional<FloatImage> bakeLightmap(const RayScene& rays, const Atlas& atlas, const IndirectField* field,
                                       const DirectInLightmap& direct, Workers& workers, const std::stop_token& stop,
                                       const std::function<void(double)>& progress)
{
    FloatImage image(atlas.size, atlas.size);
    std::vector<std::uint8_t> known(image.pixels.size(), 0);
    std::atomic<std::size_t> done = 0;
    const std::size_t blocks = (atlas.texels.size() + kBlockTexels - 1) / kBlockTexels;
    const bool all = workers.run(blocks, stop, [&](std::size_t block) {
        const std::size_t end = std::min(atlas.texels.size(), (block + 1) * kBlockTexels);
        for (std::size_t i = block * kBlockTexels; i < end && !stop.stop_requested(); ++i) {
            const SurfaceTexel& t = atlas.texels[i];
            glm::vec3 lux(0.0f);
            if (field && !field->lookup(t.position, t.normal, lux)) continue;
            if (direct.lights) {
                Rng rng(direct.seed, kStream, t.texel);
                lux += directIlluminance(rays, *direct.lights, direct.mix, t.position, t.normal, direct.samples, rng);
            }
            image.pixels[t.texel] = lux;
            known[t.texel] = 1;
        }
        const std::size_t ended = ++done;
        if (progress) progress(static_cast<double>(ended) / static_cast<double>(blocks));
    });
    if (!all || stop.stop_requested()) return {};
    dilate(atlas, std::move(known), image);
    return image;
}

} // namespace lightloom
