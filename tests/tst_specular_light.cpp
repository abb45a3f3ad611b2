// SPDX-License-Identifier: Apache-2.0
// Claims: lamps' light that comes by mirrors is that of mirrored lamps, and behind a clear pane it is what the pane
// lets through; where a mirror scatters too both parts are there once; nothing comes where there is no such surface;
// the same bits on any number of threads and whatever other lamps are asked for.
#include "core/scene/scene_builder.h"
#include "core/scene/shapes.h"
#include "core/transport/first_light.h"
#include "core/transport/specular_light.h"
#include "light_helpers.h"
#include <QtTest>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr float kCandela = 100.0f;

/// A lamp 1 m above a floor of `floor`, a dark ceiling 2 m above that.
Scene overFloor(SceneBuilder& builder, int floor)
{
    builder.add("Floor", quadMesh({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}), floor);
    builder.add("Ceiling", quadMesh({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}), builder.addMaterial("dark", glm::vec3(0.0f)));
    builder.addPoint("Lamp", {0.2f, 1, 0}, glm::vec3(kCandela, 0.5f * kCandela, kCandela));
    builder.addPoint("Other", {-0.5f, 1, 0.5f}, glm::vec3(10.0f));
    return builder.finish();
}

struct Lit {
    LitScene lit;
    std::shared_ptr<const LightReach> reach;
    std::shared_ptr<const SurfaceVoxels> voxels;
    explicit Lit(Scene scene, int cells = 96) : lit(std::move(scene))
    {
        Workers workers(2);
        reach = LightReach::find(*lit.rays, *lit.lights, workers, {});
        voxels = voxelise(lit.scene->bounds, *reach, cells, 0.3f, workers, {});
    }
    [[nodiscard]] EntryValues light(std::vector<int> groups, std::uint64_t photons, int threads = 2) const
    {
        Workers workers(threads);
        return specularLight(*lit.lights, *voxels, groups, photons, 1, workers, {});
    }
    [[nodiscard]] int group(const std::string& id) const
    {
        for (std::size_t g = 0; g < lit.scene->groups.size(); ++g)
            if (lit.scene->groups[g].id == id) return static_cast<int>(g);
        return -1;
    }
};

/// Area-weighted sums of what was found and of what is expected over entries that `counts` takes.
template<class Counts, class Expected>
void hold(const Lit& scene, const EntryValues& lux, Counts counts, Expected expected, double within)
{
    double found = 0.0, wanted = 0.0;
    for (std::size_t e = 0; e < scene.voxels->entries.size(); ++e) {
        const Orientation& o = scene.voxels->entries[e];
        if (!counts(o)) continue;
        found += static_cast<double>(o.area * lux.values[3 * e]);
        wanted += static_cast<double>(o.area) * expected(o);
        QVERIFY(std::abs(lux.values[3 * e + 1] - 0.5f * lux.values[3 * e]) <= 1e-4f * lux.values[3 * e]);
    }
    qInfo("%.4f of what is expected", found / wanted);
    QVERIFY(std::abs(found / wanted - 1.0) <= within);
}
bool isCeiling(const Orientation& o) { return o.normal.y < -0.9f && o.centroid.y > 1.5f; }
double fromPoint(const Orientation& o, glm::dvec3 lamp)
{
    const glm::dvec3 way = lamp - glm::dvec3(o.centroid);
    return kCandela * glm::dot(way, glm::dvec3(o.normal)) / std::pow(glm::dot(way, way), 1.5);
}

} // namespace

class SpecularLightTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void aMirrorShowsTheLamp() // the lamp's image below the floor, by Schlick's share; a mirror that scatters as well
    {
        for (const float metallic : {1.0f, 0.6f}) {
            SceneBuilder builder("mirror");
            Material mirror;
            mirror.baseColor = glm::vec4(glm::vec3(0.7f), 1.0f);
            mirror.metallic = metallic, mirror.roughness = 0.0f;
            const Lit scene(overFloor(builder, builder.addMaterial(mirror)));
            const EntryValues lux = scene.light({scene.group("Lamp")}, 3'000'000);
            const auto expected = [&](const Orientation& o) {
                const glm::dvec3 image(0.2, -1.0, 0.0), way = image - glm::dvec3(o.centroid);
                const double cosine = std::abs(way.y) / glm::length(way), f0 = double(metallic) * 0.7;
                const double f = f0 + (double(metallic) * double(kLargestAlbedo) - f0) * std::pow(1.0 - cosine, 5.0);
                return f * fromPoint(o, image);
            };
            hold(scene, lux, isCeiling, expected, 0.01);
            const std::vector<glm::vec3> even = entryAlbedos(*scene.lit.rays, *scene.reach, *scene.voxels),
                                         matt = entryMattAlbedos(*scene.lit.rays, *scene.reach, *scene.voxels);
            QCOMPARE(matt.size(), even.size());
            for (std::size_t e = 0; e < even.size(); ++e) {
                const Orientation& o = scene.voxels->entries[e];
                if (o.normal.y < 0.9f) continue;
                QVERIFY(std::abs(even[e].x - 0.7f) <= 1e-4f);
                QVERIFY(std::abs(matt[e].x - 0.7f * (1.0f - metallic)) <= 1e-4f);
                QCOMPARE(lux.values[3 * e], 0.0f); // straight light is not its business
            }
        }
    }

    void aPaneLetsThrough() // glass that does not bend: its tint of what would come without it
    {
        SceneBuilder builder("pane");
        builder.add("Pane", quadMesh({-4, 1.4f, -4}, {0, 0, 8}, {8, 0, 0}),
                    builder.addPane("pane", {0.6f, 0.6f, 0.6f}, 1.0f));
        const Lit scene(overFloor(builder, builder.addMaterial("grey", glm::vec3(0.5f))));
        const EntryValues lux = scene.light({scene.group("Lamp")}, 3'000'000);
        hold(
            scene, lux, isCeiling,
            [](const Orientation& o) {
                return 0.6 * fromPoint(o, {0.2, 1.0, 0.0});
            },
            0.01);
        for (std::size_t e = 0; e < scene.voxels->entries.size(); ++e)
            if (scene.voxels->entries[e].centroid.y < 0.1f) QCOMPARE(lux.values[3 * e], 0.0f);
    }

    void nothingWithoutMirrors()
    {
        SceneBuilder builder("matt");
        const Lit scene(overFloor(builder, builder.addMetal("rough", glm::vec3(0.7f), 0.5f)));
        QVERIFY(entryMattAlbedos(*scene.lit.rays, *scene.reach, *scene.voxels).empty());
        for (const float v : scene.light({0, 1}, 20'000).values) QCOMPARE(v, 0.0f);
    }

    void lampsAndThreadsDoNotMix()
    {
        SceneBuilder builder("mirror");
        const Lit scene(overFloor(builder, builder.addMetal("mirror", glm::vec3(0.7f), 0.0f)));
        const EntryValues both = scene.light({0, 1}, 30'000, 1);
        QVERIFY(scene.light({0, 1}, 30'000, 3).values == both.values);
        for (const int g : {0, 1}) {
            const EntryValues one = scene.light({g}, 30'000);
            for (std::size_t i = 0; i < one.values.size(); ++i)
                QCOMPARE(one.values[i], both.values[6 * (i / 3) + static_cast<std::size_t>(3 * g) + i % 3]);
        }
        std::stop_source source;
        source.request_stop();
        Workers workers(2);
        const std::vector<int> groups{0};
        QVERIFY(specularLight(*scene.lit.lights, *scene.voxels, groups, 30'000, 1, workers, source.get_token())
                    .values.empty());
    }
};

QTEST_APPLESS_MAIN(SpecularLightTest)
#include "tst_specular_light.moc"
