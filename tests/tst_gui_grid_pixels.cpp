// SPDX-License-Identifier: Apache-2.0
// Claim: the viewport shows what an irradiance grid says, in every form and with every filter: illuminance per pixel
// equals IrradianceGrid::lookup at the same points, as far as half floats tell.
#include "core/base/units.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "gui_fixture.h"
#include "widgets/gl/gl_probe.h"
#include <QGuiApplication>
#include <QtTest>
#include <map>

using namespace lightloom;

namespace {

constexpr glm::ivec2 kSize{320, 240};
constexpr const char* kNested = "cornell with a finer grid inside";
constexpr float kHalfStep = 1.0f / 2048.0f; ///< largest relative error of rounding to a half
constexpr float kLeastWeight = 2e-3f;       ///< of what filters find: with less, rounding of places matters

glm::vec3 xyz(glm::vec4 v) { return {v.x, v.y, v.z}; }
float largest(glm::vec3 v) { return maxChannel(glm::abs(v)); }

/// Vertices that may have a part in what a surface gets.
template<class Visit>
void forVerticesAround(const GridLattice& lattice, glm::vec3 at, const Visit& visit)
{
    const glm::ivec3 low(glm::floor(at));
    for (int k = 0; k < 64; ++k) {
        const glm::ivec3 vertex = low - 1 + glm::ivec3(k % 4, k / 4 % 4, k / 16);
        visit(lattice.index(glm::clamp(vertex, glm::ivec3(0), lattice.cells)));
    }
}

/// The largest number that a vertex around has, lux: light around, which errors are measured by.
float lightAround(const IrradianceGrid& grid, glm::vec3 p, glm::vec3 n)
{
    const GridLattice& lattice = grid.geometry().lattice;
    float most = 0.0f;
    for (const float offset : {0.0f, grid.show().offset}) {
        forVerticesAround(lattice, lookupPlace(lattice, p, n, offset), [&](std::size_t v) {
            float trust = 0.0f;
            for (std::size_t k = 0; k < remapParts(grid.show().remap).size(); ++k)
                trust = std::max(trust, grid.trust(v, k));
            if (trust <= 0.0f) return;
            for (const glm::vec3& value : grid.keptAt(v)) most = std::max(most, largest(value));
        });
    }
    return grid.inside().weight(p) > 0.0f ? std::max(most, lightAround(*grid.inside().grid, p, n)) : most;
}

/// The least weight that the parts of a tricubic lookup find; 1 for trilinear ones.
float leastWeight(const IrradianceGrid& grid, glm::vec3 p, glm::vec3 n)
{
    if (grid.show().filter == GridFilter::trilinear) return 1.0f;
    const GridLattice& lattice = grid.geometry().lattice;
    GridCorners corners;
    tricubicCorners(lattice, lookupPlace(lattice, p, n, grid.show().offset), grid.show().filter, corners);
    float least = 1.0f;
    for (std::size_t part = 0; part < remapParts(grid.show().remap).size(); ++part) {
        float weight = 0.0f;
        for (const GridCorner& c : corners) weight += c.weight * grid.trust(c.vertex, part);
        least = std::min(least, weight);
    }
    return grid.inside().weight(p) > 0.0f ? std::min(least, leastWeight(*grid.inside().grid, p, n)) : least;
}

/// What the compressed form gives: lengths and directions interpolated each on its own (RR-6983, section 4.2).
bool compressedLookup(const IrradianceGrid& grid, glm::vec3 p, glm::vec3 n, glm::vec3& lux)
{
    if (const float part = grid.inside().weight(p); part > 0.0f) {
        glm::vec3 fine, coarse;
        const bool isFine = compressedLookup(*grid.inside().grid, p, n, fine);
        const bool isCoarse = compressedLookup(*grid.withInside({}), p, n, coarse);
        lux = isFine && isCoarse ? glm::mix(coarse, fine, part) : isFine ? fine : coarse;
        return isFine || isCoarse;
    }
    const GridLattice& lattice = grid.geometry().lattice;
    GridCorners corners;
    const glm::vec3 at = lookupPlace(lattice, p, n, grid.show().offset);
    if (grid.show().filter == GridFilter::trilinear) {
        trilinearCorners(grid.geometry(), at, p, n, CornerSide::before, corners);
    } else {
        tricubicCorners(lattice, at, grid.show().filter, corners);
    }
    float share = 0.0f;
    lux = glm::vec3(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t d = sideOf(axis, n);
        glm::vec3 lengths(0.0f), direction(0.0f);
        float weight = 0.0f;
        for (const GridCorner& c : corners) {
            const float w = c.weight * grid.trust(c.vertex, std::size_t(axis));
            const auto kept = grid.keptAt(c.vertex);
            glm::vec3 sum(0.0f), long3(0.0f);
            for (int channel = 0; channel < 3; ++channel) {
                const glm::vec3 one(kept[3 * d][channel], kept[3 * d + 1][channel], kept[3 * d + 2][channel]);
                long3[channel] = glm::length(one);
                sum += one;
            }
            weight += w;
            lengths += w * long3;
            if (glm::length(sum) > 0.0f) direction += w * glm::normalize(sum);
        }
        if (weight <= 0.0f) continue;
        lux += n[axis] * n[axis] * (lengths / weight) * glm::dot(direction / weight, n);
        share += n[axis] * n[axis];
    }
    if (share <= 0.0f) return false;
    lux = glm::max(lux / share, glm::vec3(0.0f));
    return true;
}

/// A sheet of small squares whose normals wave about its own by up to 74 degrees, as a map's or a smooth hull's do.
Mesh wavySheet(glm::vec3 corner, glm::vec3 along, glm::vec3 up)
{
    constexpr int kSide = 48;
    const glm::vec3 normal = glm::normalize(glm::cross(along, up)), u = glm::normalize(along), v = glm::normalize(up);
    Mesh mesh;
    for (int j = 0; j <= kSide; ++j) {
        for (int i = 0; i <= kSide; ++i) {
            const float s = float(i) / float(kSide), t = float(j) / float(kSide);
            mesh.positions.push_back(corner + s * along + t * up);
            const glm::vec2 wave(std::sin(40.0f * s), std::sin(35.0f * t));
            mesh.normals.push_back(glm::normalize(normal + 2.5f * (wave.x * u + wave.y * v)));
            if (i == kSide || j == kSide) continue;
            const auto at = static_cast<unsigned>(j * (kSide + 1) + i), next = at + unsigned(kSide) + 1u;
            mesh.triangles.push_back({at, at + 1u, next + 1u});
            mesh.triangles.push_back({at, next + 1u, next});
        }
    }
    return mesh;
}

/// A room of wavy walls, seen from within, a lamp under its ceiling.
Scene wavyRoom()
{
    SceneBuilder builder("wavy");
    const int grey = builder.addMaterial("grey", glm::vec3(0.7f)), red = builder.addMaterial("red", {0.7f, 0.2f, 0.2f});
    builder.add("Floor", wavySheet({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), grey);
    builder.add("Ceiling", wavySheet({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}), grey);
    builder.add("Back", wavySheet({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}), grey);
    builder.add("Front", wavySheet({1, 0, 1}, {-2, 0, 0}, {0, 2, 0}), grey);
    builder.add("Left", wavySheet({-1, 0, 1}, {0, 0, -2}, {0, 2, 0}), red);
    builder.add("Right", wavySheet({1, 0, -1}, {0, 0, 2}, {0, 2, 0}), grey);
    builder.addPoint("Lamp", {0.3f, 1.6f, 0.2f}, glm::vec3(60.0f));
    builder.addCamera("Corner", {0.5f, 1.2f, 0.7f}, {-1.0f, 0.3f, -1.0f}, 60.0f);
    builder.setExposure(4.0f);
    return builder.finish();
}

} // namespace

class GridPixelsTest : public QObject {
    Q_OBJECT
    GlFixture gl_;
    std::map<std::pair<std::string, float>, std::shared_ptr<const IrradianceGrid>> baked_;

    /// A grid of 16 cells in a sample scene.
    std::shared_ptr<const IrradianceGrid> bake(const std::string& name, const std::shared_ptr<const Scene>& scene,
                                               float shift)
    {
        auto& kept = baked_[{name, shift}];
        if (kept) return kept;
        BakeParams params;
        params.photonCount = 60'000;
        params.gridSize = 16;
        params.gridShift = shift;
        if (name == kNested) { // about a corner
            const glm::vec3 low = scene->bounds.low + glm::vec3(scene->origin), size = scene->bounds.size();
            params.gridNest = GridNest::box;
            params.gridNestLowX = low.x - 0.1f * size.x, params.gridNestHighX = low.x + 0.6f * size.x;
            params.gridNestLowY = low.y - 0.1f * size.y, params.gridNestHighY = low.y + 0.6f * size.y;
            params.gridNestLowZ = low.z - 0.1f * size.z, params.gridNestHighZ = low.z + 0.6f * size.z;
        }
        if (name == "wavy") params.gridSize = 6;
        if (name == "gallery") params.gridSizeY = 12, params.gridSizeZ = 7; // cells that are no cubes
        return kept = bakeGrid(scene, params);
    }

private Q_SLOTS:
    void initTestCase() { QVERIFY(gl_.start(kSize)); }

    void indirectEqualsLookup_data()
    {
        QTest::addColumn<QString>("scene");
        QTest::addColumn<float>("shift");
        QTest::addColumn<int>("remap");
        QTest::addColumn<int>("filter");
        QTest::addColumn<bool>("isCompressed");
        const auto row = [](const char* name, float shift, GridRemap remap, GridFilter filter, bool isCompressed) {
            QTest::addRow("%s, shift %g, %s%s, %s", name, double(shift), kGridRemapNames[std::size_t(remap)].data(),
                          isCompressed ? " compressed" : "", kGridFilterNames[std::size_t(filter)].data())
                << QString(name) << shift << int(remap) << int(filter) << isCompressed;
        };
        row("cornell", 0.0f, GridRemap::joined, GridFilter::trilinear, false);
        row("cornell", 0.5f, GridRemap::joined, GridFilter::trilinear, false);
        row("two_rooms", 0.25f, GridRemap::joined, GridFilter::trilinear, false);
        for (const GridRemap remap : {GridRemap::flux, GridRemap::harmonic, GridRemap::paper})
            row("cornell", 0.5f, remap, GridFilter::trilinear, false);
        for (const GridRemap remap : {GridRemap::joined, GridRemap::flux, GridRemap::harmonic, GridRemap::paper})
            row("cornell", 0.5f, remap, GridFilter::bspline, false);
        row("two_rooms", 0.25f, GridRemap::joined, GridFilter::bspline, false);
        row("gallery", 0.75f, GridRemap::joined, GridFilter::trilinear, false);
        row("gallery", 0.75f, GridRemap::joined, GridFilter::bspline, false);
        row("cornell", 0.5f, GridRemap::joined, GridFilter::catmullRom, false);
        row("cornell", 0.5f, GridRemap::paper, GridFilter::trilinear, true);
        row("cornell", 0.5f, GridRemap::paper, GridFilter::bspline, true);
        for (const GridRemap remap : {GridRemap::joined, GridRemap::flux, GridRemap::harmonic, GridRemap::paper}) {
            for (const GridFilter filter : {GridFilter::trilinear, GridFilter::bspline, GridFilter::catmullRom})
                row(kNested, 0.25f, remap, filter, false);
        }
        for (const GridFilter filter : {GridFilter::trilinear, GridFilter::bspline})
            row(kNested, 0.25f, GridRemap::paper, filter, true);
    }
    void indirectEqualsLookup()
    {
        QFETCH(QString, scene);
        QFETCH(float, shift);
        QFETCH(int, remap);
        QFETCH(int, filter);
        QFETCH(bool, isCompressed);
        Result<Scene> made = sampleScene(scene == kNested ? "cornell" : scene.toStdString());
        QVERIFY(made);
        const auto shown = std::make_shared<const Scene>(std::move(*made));
        const auto baked = bake(scene.toStdString(), shown, shift);
        QVERIFY(baked);
        const auto grid = baked->withShow({GridRemap(remap), GridFilter(filter), 0.5f});
        const auto gpu = makeGpuGrid(*grid, isCompressed ? GridPacking::compressed : GridPacking::exact);
        auto renderer = Renderer::make(*gl_.gl);
        QVERIFY2(gpu && renderer, renderer ? "" : renderer.error().message.c_str());
        Renderer& draw = **renderer;
        QVERIFY(draw.setScene(makeDrawData(shown)));
        const Result<Done> set = draw.setGrid(std::make_shared<GpuGrid>(*gpu));
        QVERIFY2(set, set ? "" : set.error().message.c_str());
        FrameView frame = viewOf(*shown, 0, kSize);
        frame.mode = ViewMode::grid;
        QVERIFY(draw.draw(frame, 0, kSize, gl_.target(), kSize));
        const auto pixels = draw.illuminance(frame, true);
        const auto surfaces = draw.readBack();
        // Each number read is a half, rounded by up to kHalfStep, and so is the trust that sums of them are divided
        // by; the slope reaches up to 1.5 cells at half of the light a cell, and its place is off likewise; terms
        // between the axes come on top. All of these together: eight roundings of the largest number around.
        // Catmull-Rom's weights add up to 1.95 without their signs, over at least half of them found.
        const float roundings = GridFilter(filter) == GridFilter::catmullRom ? 32.0f : 8.0f;
        std::size_t seen = 0, beyond = 0, missing = 0, faint = 0, within = 0, seam = 0;
        float worst = 0.0f, mean = 0.0f, sum = 0.0f;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            if (surfaces.position[i].w < 0.5f) continue;
            const glm::vec3 p = xyz(surfaces.position[i]), n = xyz(surfaces.normal[i]);
            glm::vec3 lux(0.0f);
            const bool isKnown = isCompressed ? compressedLookup(*grid, p, n, lux) : grid->lookup(p, n, lux);
            ++seen;
            const float part = grid->inside().weight(p);
            within += part >= 1.0f ? 1 : 0;
            seam += part > 0.0f && part < 1.0f ? 1 : 0;
            if (isKnown != (pixels[i].w > 0.5f)) ++missing;
            if (!isKnown || pixels[i].w < 0.5f) continue;
            if (leastWeight(*grid, p, n) < kLeastWeight) {
                ++faint;
                continue;
            }
            const float error = largest(xyz(pixels[i]) - lux) / lightAround(*grid, p, n);
            beyond += error <= roundings * kHalfStep ? 0 : 1;
            worst = std::max(worst, error);
            sum += error;
            mean += luminance(lux);
        }
        qInfo("%s: mean error %.2e, worst %.2e of the light around (allowed %.2e), beyond it %zu, missing %zu, faint "
              "%zu of %zu pixels; mean %.3g lx",
              QTest::currentDataTag(), double(sum) / double(seen), double(worst), double(roundings * kHalfStep), beyond,
              missing, faint, seen, double(mean) / double(seen));
        QVERIFY(seen > kSize.x * kSize.y / 2);
        QVERIFY(mean > 0.0f);
        // few pixels sit where rounding decides whether enough is seen, or which lookup answers
        QVERIFY(beyond <= seen / 2000);
        QVERIFY(missing <= seen / 2000);
        QVERIFY(faint <= seen / 50);
        if (scene == kNested) {
            qInfo("%zu pixels within the finer grid, %zu between", within, seam);
            QVERIFY(within > 5000 && seam > 1000 && within + seam < seen / 2);
            QCOMPARE(gpu->memoryBytes(),
                     2 * (gpu->light.size() + gpu->sight.size()) + 4 * gpu->places.size() + gpu->inside->memoryBytes());
        }
    }

    void dimmingNeedsNoBake() // the same layers under another mix, however bright
    {
        const auto scene = std::make_shared<const Scene>(twoRooms());
        const auto baked = bake("two_rooms", scene, 0.25f);
        auto renderer = Renderer::make(*gl_.gl);
        QVERIFY(baked && renderer);
        Renderer& draw = **renderer;
        QVERIFY(draw.setScene(makeDrawData(scene)));
        FrameView frame = viewOf(*scene, 0, kSize);
        frame.mode = ViewMode::grid;
        QVERIFY(draw.draw(frame, 0, kSize, gl_.target(), kSize));
        const auto surfaces = draw.readBack();
        std::vector<std::vector<glm::vec4>> shown;
        const std::size_t groups = scene->groups.size();
        QVERIFY(groups >= 2);
        Mix first(groups, glm::vec3(0.0f)), rest(groups, glm::vec3(1e6f));
        first[0] = glm::vec3(1e6f), rest[0] = glm::vec3(0.0f);
        for (const Mix& mix : {Mix(groups, glm::vec3(1e6f)), first, rest}) {
            const auto mixed = std::dynamic_pointer_cast<const IrradianceGrid>(baked->withMix(mix));
            const auto gpu = makeGpuGrid(*mixed);
            QVERIFY(gpu && draw.setGrid(std::make_shared<GpuGrid>(*gpu)));
            shown.push_back(draw.illuminance(frame, true));
        }
        std::size_t lit = 0;
        for (std::size_t i = 0; i < shown[0].size(); ++i) {
            const glm::vec3 all = xyz(shown[0][i]), parts = xyz(shown[1][i]) + xyz(shown[2][i]);
            if (surfaces.position[i].w < 0.5f || largest(all) < 1e6f) continue; // dark corners of each clamp at 0
            ++lit;
            const float around = 1e6f * lightAround(*baked, xyz(surfaces.position[i]), xyz(surfaces.normal[i]));
            QVERIFY(largest(all - parts) <= 16.0f * kHalfStep * around);
        }
        QVERIFY(lit > 1000);
    }

    void aGuestIsLitByTheGrid_data()
    {
        QTest::addColumn<int>("filter");
        QTest::newRow("trilinear") << int(GridFilter::trilinear);
        QTest::newRow("b-spline") << int(GridFilter::bspline);
    }
    void aGuestIsLitByTheGrid() // a ball that was not there when it was baked, at two places, by the same textures
    {
        QFETCH(int, filter);
        const auto scene = std::make_shared<const Scene>(cornellBox());
        const auto baked = bake("cornell", scene, 0.0f);
        auto renderer = Renderer::make(*gl_.gl);
        QVERIFY(baked && renderer);
        Renderer& draw = **renderer;
        QVERIFY(draw.setScene(makeDrawData(scene)));
        const auto grid = baked->withShow({GridRemap::joined, GridFilter(filter), 0.5f});
        QVERIFY(draw.setGrid(std::make_shared<GpuGrid>(*makeGpuGrid(*grid))));
        FrameView frame = viewOf(*scene, 0, kSize);
        frame.mode = ViewMode::grid;
        QVERIFY(draw.draw(frame, 0, kSize, gl_.target(), kSize));
        const auto without = draw.readBack();
        SceneBuilder builder("guest");
        const float radius = 0.14f * scene->bounds.longestSide();
        builder.add("Ball", sphereMesh(glm::vec3(0.0f), radius, 32), builder.addMaterial("grey", glm::vec3(0.5f)));
        draw.setGuest(makeDrawData(std::make_shared<const Scene>(builder.finish())));
        for (const glm::vec3 shift : {glm::vec3(-1.5f, 1.2f, 0.0f), glm::vec3(1.4f, 2.0f, 1.0f)}) {
            const glm::vec3 centre = scene->bounds.centre() + radius * shift;
            draw.setGuestPlace(glm::translate(glm::mat4(1.0f), centre));
            QVERIFY(draw.draw(frame, 0, kSize, gl_.target(), kSize));
            const auto pixels = draw.illuminance(frame, true);
            const auto surfaces = draw.readBack();
            std::size_t onBall = 0;
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                if (surfaces.position[i] == without.position[i]) continue;
                const glm::vec3 p = xyz(surfaces.position[i]), n = xyz(surfaces.normal[i]);
                ++onBall;
                QVERIFY(std::abs(glm::length(p - centre) - radius) <= 0.01f * radius);
                glm::vec3 lux(0.0f);
                QVERIFY(grid->lookup(p, n, lux) && pixels[i].w > 0.5f); // in mid-air it always has an answer
                QVERIFY(largest(xyz(pixels[i]) - lux) <= 8.0f * kHalfStep * lightAround(*grid, p, n));
            }
            qInfo("%s: %zu pixels of the ball", QTest::currentDataTag(), onBall);
            QVERIFY(onBall > 1000);
        }
        draw.setGuest(nullptr);
        QVERIFY(draw.draw(frame, 0, kSize, gl_.target(), kSize));
        QVERIFY(draw.readBack().position == without.position);
    }

    void bentNormalsInCornersAreLit() // all that is before them may lie in a wall
    {
        const auto scene = std::make_shared<const Scene>(wavyRoom());
        const auto grid = bake("wavy", scene, 0.25f);
        auto renderer = Renderer::make(*gl_.gl);
        QVERIFY(grid && renderer);
        Renderer& draw = **renderer;
        QVERIFY(draw.setScene(makeDrawData(scene)));
        QVERIFY(draw.setGrid(std::make_shared<GpuGrid>(*makeGpuGrid(*grid))));
        FrameView frame = viewOf(*scene, 0, kSize);
        frame.mode = ViewMode::grid;
        QVERIFY(draw.draw(frame, 0, kSize, gl_.target(), kSize));
        const auto pixels = draw.illuminance(frame, true);
        const auto surfaces = draw.readBack();
        std::size_t seen = 0, cornered = 0;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            if (surfaces.position[i].w < 0.5f) continue;
            const glm::vec3 p = xyz(surfaces.position[i]), n = xyz(surfaces.normal[i]);
            ++seen;
            glm::vec3 lux(0.0f);
            QVERIFY(grid->lookup(p, n, lux) && pixels[i].w > 0.5f);
            QVERIFY(largest(xyz(pixels[i]) - lux) <= 8.0f * kHalfStep * lightAround(*grid, p, n));
            GridCorners corners;
            for (const float offset : {grid->show().offset, 0.0f})
                trilinearCorners(grid->geometry(), lookupPlace(grid->geometry().lattice, p, n, offset), p, n,
                                 CornerSide::before, corners);
            cornered += corners.isEmpty() ? 1 : 0;
        }
        qInfo("%zu of %zu pixels have no vertex before them", cornered, seen);
        QVERIFY(seen > pixels.size() * 9 / 10 && cornered > 20);
    }

    void anOctreeTakesItsPlace() // and it the octree's: what was set last is shown
    {
        const auto scene = std::make_shared<const Scene>(cornellBox());
        const auto baked = bake("cornell", scene, 0.0f);
        BakeParams params;
        params.photonCount = 30'000;
        params.octreeFirstDepth = params.octreeDepth = 4;
        const auto octree = bakeOctree(scene, params);
        auto renderer = Renderer::make(*gl_.gl);
        QVERIFY(baked && octree && renderer);
        Renderer& draw = **renderer;
        QVERIFY(draw.setScene(makeDrawData(scene)));
        FrameView frame = viewOf(*scene, 0, kSize);
        QVERIFY(draw.draw(frame, 0, kSize, gl_.target(), kSize));
        const auto grid = std::make_shared<GpuGrid>(*makeGpuGrid(*baked));
        const auto leaves = std::make_shared<GpuOctree>(*makeGpuOctree(*octree));
        QVERIFY(draw.setGrid(grid));
        const auto ofGrid = draw.illuminance(frame, true);
        QVERIFY(draw.setOctree(leaves));
        const auto ofOctree = draw.illuminance(frame, true);
        QVERIFY(!(ofGrid == ofOctree));
        QVERIFY(draw.setGrid(grid));
        QVERIFY(draw.illuminance(frame, true) == ofGrid);
        QVERIFY(draw.setGrid(nullptr));
        for (const glm::vec4& pixel : draw.illuminance(frame, true)) QVERIFY(pixel == glm::vec4(0.0f));
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QGuiApplication application(argc, argv);
    GridPixelsTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_grid_pixels.moc"
