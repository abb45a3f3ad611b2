// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/irradiance_grid.h"
#include "core/base/units.h"
#include "core/ivg/grid_openness.h"
#include <algorithm>
#include <cmath>

namespace lightloom {
namespace {

constexpr float kSteepest = 0.5f;     ///< of a lamp's light at a vertex, per cell
constexpr int kSpreads = 2;           ///< vertices deep that values are carried into walls for Catmull-Rom
constexpr float kLeastKnown = 0.005f; ///< of trilinear weights: less comes from round a corner
/// The same at the surface itself: in the corner of three walls that keep .15 of a cell off planes .0034 is in the
/// room.
constexpr float kLeastKnownThere = 0.003f;
constexpr float kLeastCubic = 0.5f; ///< of Catmull-Rom's weights that must find a value

} // namespace

IrradianceGrid::IrradianceGrid(std::shared_ptr<const GridGeometry> geometry,
                               std::vector<std::shared_ptr<const GridLayer>> layers, GridEstimator estimator, Mix mix,
                               GridShow show)
    : geometry_(std::move(geometry)), layers_(std::move(layers)), estimator_(estimator), mix_(std::move(mix)),
      show_(show), parts_(remapParts(show.remap))
{
    weigh();
    mixLayers();
    if (hasSlopes()) findSlopes();
    if (show_.filter == GridFilter::catmullRom) spread();
}

void IrradianceGrid::weigh()
{
    const GridOpenness& openness = geometry_->openness;
    const auto enough = [](float share) { return share >= kLeastOpen ? share : 0.0f; };
    const std::size_t count = geometry_->lattice.vertexCount();
    trust_.resize(count * parts());
    for (std::size_t i = 0; i < count; ++i) {
        glm::vec3 share =
            estimator_ == GridEstimator::tracks ? glm::vec3(openness.cellShare[i]) : openness.faceShare[i];
        if (openness.isOpen[i] == 0) share = glm::vec3(0.0f);
        for (std::size_t k = 0; k < parts(); ++k) {
            const int axis = parts_[k].axis;
            trust_[i * parts() + k] = enough(axis < 0 ? glm::min(share.x, glm::min(share.y, share.z)) : share[axis]);
        }
    }
}

IrradianceVectors IrradianceGrid::mixedVectors(std::size_t vertex) const
{
    IrradianceVectors mixed{};
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        const glm::vec3 gain = gainOf(mix_, static_cast<int>(g));
        if (!layers_[g] || gain == glm::vec3(0.0f)) continue;
        for (std::size_t d = 0; d < 6; ++d) {
            const glm::mat3& one = layers_[g]->vectors[vertex][d];
            for (int channel = 0; channel < 3; ++channel) mixed[d][channel] += gain[channel] * one[channel];
        }
    }
    return mixed;
}

void IrradianceGrid::mixLayers()
{
    const std::size_t count = geometry_->lattice.vertexCount(), size = remapSize(show_.remap);
    kept_.resize(count * size);
    variance_.assign(count, {});
    for (std::size_t i = 0; i < count; ++i) keepForRemap(show_.remap, mixedVectors(i), {kept_.data() + i * size, size});
    for (std::size_t g = 0; g < layers_.size() && hasSlopes(); ++g) {
        const glm::vec3 gain = gainOf(mix_, static_cast<int>(g));
        if (!layers_[g] || layers_[g]->onSurface.empty() || gain == glm::vec3(0.0f)) continue;
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t d = 0; d < 6; ++d) kept_[i * size + d] += gain * layers_[g]->onSurface[i][d];
        }
    }
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        const float light = luminance(gainOf(mix_, static_cast<int>(g))); // as good as a tint lets it be
        if (!layers_[g] || light == 0.0f) continue;
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t d = 0; d < 6; ++d) variance_[i][d] += light * light * layers_[g]->variance[i][d];
        }
    }
}

/// The first vertices before a wall stand off it, and light grows with the distance from most walls: by 1 to 2 % of the
/// mean in cornell. So surfaces are told how light goes on to them, by a line through all that the vertices around
/// know: the noise of single vertices would be more than what is won. Each lamp has its own, no steeper than kSteepest
/// of its own light, so that lamps add up and nothing comes from where there is none (round the edge of a sunlit roof,
/// say).
void IrradianceGrid::findSlopes()
{
    const GridLattice& lattice = geometry_->lattice;
    slopes_.assign(lattice.vertexCount(), {});
    std::vector<std::array<glm::vec3, 6>> flux(lattice.vertexCount());
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        const glm::vec3 gain = gainOf(mix_, static_cast<int>(g));
        if (!layers_[g] || gain == glm::vec3(0.0f)) continue;
        for (std::size_t i = 0; i < flux.size(); ++i) keepForRemap(GridRemap::flux, layers_[g]->vectors[i], flux[i]);
        for (std::size_t i = 0; i < flux.size(); ++i) {
            if (geometry_->openness.isOpen[i] == 0) continue;
            const std::array<glm::vec3, 6> slopes = slopesAt(i, flux);
            for (std::size_t d = 0; d < 6; ++d) {
                const glm::vec3 most = kSteepest * flux[i][d];
                slopes_[i][d] += gain * glm::clamp(slopes[d], -most, most);
            }
        }
    }
}

/// By direction, the slope along it of a line through what a vertex and those around that it sees have, per cell.
std::array<glm::vec3, 6> IrradianceGrid::slopesAt(std::size_t vertex,
                                                  std::span<const std::array<glm::vec3, 6>> flux) const
{
    const GridLattice& lattice = geometry_->lattice;
    struct Line {
        float weight = 0.0f, x = 0.0f, xx = 0.0f;
        std::array<glm::vec3, 2> y{glm::vec3(0.0f), glm::vec3(0.0f)}, xy{glm::vec3(0.0f), glm::vec3(0.0f)};
    };
    std::array<Line, 3> lines;
    for (int k = 0; k < 27; ++k) {
        const glm::ivec3 step = glm::ivec3(k % 3, k / 3 % 3, k / 9) - 1, to = lattice.vertex(vertex) + step;
        bool isSeen = to == glm::clamp(to, glm::ivec3(0), lattice.cells);
        for (int axis = 0; axis < 3; ++axis) {
            const std::size_t way = static_cast<std::size_t>(2 * axis + (step[axis] > 0 ? 1 : 0));
            const auto sight = static_cast<float>(geometry_->openness.sight[vertex][way]);
            isSeen = isSeen && (step[axis] == 0 || sight >= GridOpenness::kSightUnits);
        }
        if (!isSeen) continue;
        const std::size_t other = lattice.index(to);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Line& line = lines[axis];
            const float w = trust(other, axis), x = static_cast<float>(step[int(axis)]);
            line.weight += w, line.x += w * x, line.xx += w * x * x;
            for (std::size_t side = 0; side < 2; ++side) {
                const glm::vec3 value = flux[other][2 * axis + side];
                line.y[side] += w * value, line.xy[side] += w * x * value;
            }
        }
    }
    std::array<glm::vec3, 6> slopes{};
    for (std::size_t d = 0; d < 6; ++d) {
        const Line& line = lines[d / 2];
        const float spread = line.weight * line.xx - line.x * line.x;
        if (spread <= 1e-3f * line.weight * line.weight) continue; // all in one plane
        slopes[d] = (line.weight * line.xy[d % 2] - line.x * line.y[d % 2]) / spread;
    }
    return slopes;
}

/// Gives vertices behind walls, where nothing is known, the mean of what is known around them.
void IrradianceGrid::spread()
{
    const GridLattice& lattice = geometry_->lattice;
    const std::size_t size = remapSize(show_.remap);
    for (int round = 0; round < kSpreads; ++round) {
        const std::vector<float> known = trust_;
        const std::vector<glm::vec3> before = kept_;
        for (std::size_t i = 0; i < lattice.vertexCount(); ++i) {
            for (std::size_t part = 0; part < parts(); ++part) {
                if (known[i * parts() + part] > 0.0f) continue;
                float sum = 0.0f;
                const auto [first, count, axis] = parts_[part];
                std::array<glm::vec3, 18> values{};
                for (int k = 0; k < 27; ++k) {
                    const glm::ivec3 to = lattice.vertex(i) + glm::ivec3(k % 3, k / 3 % 3, k / 9) - 1;
                    if (to != glm::clamp(to, glm::ivec3(0), lattice.cells)) continue;
                    const std::size_t other = lattice.index(to);
                    const float weight = known[other * parts() + part];
                    sum += weight;
                    for (std::size_t v = 0; v < count; ++v) values[v] += weight * before[other * size + first + v];
                }
                if (sum <= 0.0f) continue;
                for (std::size_t v = 0; v < count; ++v) kept_[i * size + first + v] = values[v] / sum;
                trust_[i * parts() + part] = kLeastOpen;
            }
        }
    }
    for (float& t : trust_) t = t > 0.0f ? 1.0f : 0.0f; // weights below 0 do not go with shares
}

bool IrradianceGrid::findCorners(glm::vec3 p, glm::vec3 n, GridCorners& corners) const
{
    const GridLattice& lattice = geometry_->lattice;
    const glm::vec3 surface = lattice.toGrid(p);
    if (!(glm::all(glm::greaterThanEqual(surface, glm::vec3(-1.0f))) &&
          glm::all(glm::lessThanEqual(surface, glm::vec3(lattice.cells + 1)))))
        return false;
    if (show_.filter != GridFilter::trilinear) {
        corners.clear();
        tricubicCorners(lattice, lookupPlace(lattice, p, n, show_.offset), show_.filter, corners);
        return true;
    }
    struct Try {
        float offset, leastKnown;
        CornerSide side;
    };
    // in a gap or a corner, nearer vertices may be the only ones
    for (const auto [offset, leastKnown, side] :
         {Try{show_.offset, kLeastKnown, CornerSide::before}, Try{0.0f, kLeastKnownThere, CornerSide::leaning}}) {
        corners.clear();
        trilinearCorners(*geometry_, lookupPlace(lattice, p, n, offset), p, n, side, corners);
        float known = 0.0f;
        for (const GridCorner& c : corners) {
            float most = 0.0f;
            for (std::size_t part = 0; part < parts(); ++part) most = std::max(most, trust(c.vertex, part));
            known += most > 0.0f ? c.known : 0.0f;
        }
        if (known > leastKnown) return true;
    }
    return false;
}

bool IrradianceGrid::blend(const GridCorners& corners, glm::vec3 p, glm::vec3 n, glm::vec3& lux) const
{
    const glm::vec3 surface = geometry_->lattice.toGrid(p);
    glm::vec3 sum(0.0f), correction(0.0f);
    float share = 0.0f; // of the whole that is known
    for (std::size_t k = 0; k < parts(); ++k) {
        const RemapPart& part = parts_[k];
        const RemapForm form = remapForm(show_.remap, part, n);
        if (form.isEmpty()) continue;
        glm::vec3 light(0.0f), slope(0.0f);
        float weight = 0.0f, wanted = 0.0f, place = 0.0f;
        for (const GridCorner& c : corners) {
            wanted += c.weight;
            const float w = c.weight * trust(c.vertex, k);
            if (w == 0.0f) continue;
            weight += w;
            light += w * form.of(keptAt(c.vertex));
            if (part.axis < 0 || !hasSlopes()) continue;
            slope += w * slopes_[c.vertex][sideOf(part.axis, n)];
            place += w * static_cast<float>(geometry_->lattice.vertex(c.vertex)[part.axis]);
        }
        const bool isKnown = show_.filter == GridFilter::catmullRom ? weight > kLeastCubic * wanted : weight > 0.0f;
        if (!isKnown) continue;
        if (part.axis < 0 && show_.remap == GridRemap::joined) {
            correction = light / weight;
            continue;
        }
        if (part.axis >= 0 && hasSlopes()) {
            light += n[part.axis] * n[part.axis] * (surface[part.axis] - place / weight) * slope;
        }
        sum += light / weight;
        share += part.axis < 0 ? 1.0f : n[part.axis] * n[part.axis];
    }
    if (share <= 0.0f) return false;
    lux = glm::max(sum / share + correction, glm::vec3(0.0f));
    return true;
}

bool IrradianceGrid::ownLookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const
{
    lux = glm::vec3(0.0f);
    GridCorners corners;
    return findCorners(p, n, corners) && blend(corners, p, n, lux);
}

std::optional<float> IrradianceGrid::ownNoise(glm::vec3 p, glm::vec3 n) const
{
    GridCorners corners;
    if (!findCorners(p, n, corners)) return {};
    float variance = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        float square = 0.0f, weight = 0.0f;
        const std::size_t part = show_.remap == GridRemap::harmonic ? 0 : static_cast<std::size_t>(axis);
        for (const GridCorner& c : corners) {
            const float w = c.weight * trust(c.vertex, part);
            weight += w;
            square += w * w * variance_[c.vertex][sideOf(axis, n)];
        }
        const float squared = n[axis] * n[axis];
        if (weight > 0.0f) variance += squared * squared * square / (weight * weight);
    }
    return std::sqrt(variance);
}

float GridInside::weight(glm::vec3 p) const
{
    if (!grid) return 0.0f;
    const glm::vec3 depth = glm::min(p - box.low, box.high - p);
    return glm::smoothstep(0.0f, fade, std::min({depth.x, depth.y, depth.z}));
}

bool IrradianceGrid::lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const
{
    const float part = inside_.weight(p);
    glm::vec3 fine(0.0f);
    const bool isFine = part > 0.0f && inside_.grid->lookup(p, n, fine);
    if (isFine && part >= 1.0f) {
        lux = fine;
        return true;
    }
    const bool isCoarse = ownLookup(p, n, lux);
    if (isFine) lux = isCoarse ? glm::mix(lux, fine, part) : fine;
    return isFine || isCoarse;
}

std::optional<float> IrradianceGrid::noise(glm::vec3 p, glm::vec3 n) const
{
    const float part = inside_.weight(p);
    const std::optional<float> coarse = ownNoise(p, n);
    const std::optional<float> fine = part > 0.0f ? inside_.grid->noise(p, n) : std::nullopt;
    if (!fine || !coarse) return fine ? fine : coarse;
    return glm::mix(*coarse, *fine, part); // of the same photons: they err together
}

std::shared_ptr<const IndirectField> IrradianceGrid::withMix(Mix mix) const
{
    const auto mixed = std::make_shared<IrradianceGrid>(geometry_, layers_, estimator_, mix, show_);
    mixed->inside_ = inside_;
    if (inside_.grid) {
        mixed->inside_.grid =
            std::make_shared<IrradianceGrid>(inside_.grid->geometry_, inside_.grid->layers_, estimator_, mix, show_);
    }
    return mixed;
}

std::shared_ptr<const IrradianceGrid> IrradianceGrid::withShow(GridShow show) const
{
    const auto shown = std::make_shared<IrradianceGrid>(geometry_, layers_, estimator_, mix_, show);
    shown->inside_ = inside_;
    if (inside_.grid) shown->inside_.grid = inside_.grid->withShow(show);
    return shown;
}

std::shared_ptr<const IrradianceGrid> IrradianceGrid::withInside(GridInside inside) const
{
    const auto nested = std::make_shared<IrradianceGrid>(*this);
    nested->inside_ = std::move(inside);
    return nested;
}

std::size_t IrradianceGrid::memoryBytes() const
{
    std::size_t sum = geometry_->memoryBytes() + geometry_->lattice.vertexCount() * bytesPerVertex(show_.remap);
    for (const auto& layer : layers_) sum += layer ? layer->memoryBytes() : 0;
    return sum + (inside_.grid ? inside_.grid->memoryBytes() : 0);
}

std::size_t IrradianceGrid::bytesPerVertex(GridRemap remap)
{
    const bool isSloped = remap == GridRemap::joined || remap == GridRemap::flux;
    return remapSize(remap) * sizeof(glm::vec3) + remapParts(remap).size() * sizeof(float) +
           sizeof(std::array<float, 6>) + (isSloped ? sizeof(std::array<glm::vec3, 6>) : 0);
}

} // namespace lightloom
