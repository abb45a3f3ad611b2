// SPDX-License-Identifier: Apache-2.0
// Claims: every face that light reaches and that is drawn has one place in the atlas; places never overlap; whatever
// bilinear lookups read on a surface, in mips 0 to 2, belongs to its chart; texels stand for the surface under them;
// the same atlas on any number of threads; nothing hangs or turns into NaN, whatever the triangles.
#include "core/atlas/flat_overlap.h"
#include "core/atlas/scene_uv.h"
#include "core/base/rng.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "tests/atlas_helpers.h"
#include <map>
#include <set>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// Something in a closed grey room with a lamp, so that light reaches it from all sides.
Scene inRoom(const std::function<void(SceneBuilder&)>& add, float half = 2.0f)
{
    SceneBuilder builder("room");
    const int grey = builder.addMaterial("grey", glm::vec3(0.5f));
    builder.add("Room", boxMesh(glm::vec3(-half), glm::vec3(half), Facing::in), grey);
    builder.addPoint("Lamp", glm::vec3(0.8f, 0.9f, 0.7f) * half, glm::vec3(100.0f));
    add(builder);
    return builder.finish();
}

Material sheetMaterial(bool doubleSided)
{
    Material material;
    material.name = "sheet";
    material.metallic = 0.0f;
    material.baseColor = glm::vec4(0.5f, 0.5f, 0.5f, 1.0f);
    material.doubleSided = doubleSided;
    return material;
}

Mesh soup(int triangles, float size)
{
    Mesh mesh;
    Rng rng(1, 2, 3);
    const auto point = [&] { return (glm::vec3(rng.uniform(), rng.uniform(), rng.uniform()) - 0.5f) * size; };
    for (int i = 0; i < triangles; ++i) {
        const glm::vec3 a = point();
        for (const glm::vec3 p : {a, a + 0.1f * point(), a + 0.1f * point()}) mesh.positions.push_back(p);
        const auto first = static_cast<unsigned>(3 * i);
        mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    return mesh;
}

Mesh mobius(int steps)
{
    Mesh mesh;
    for (int i = 0; i < steps; ++i) {
        const double turn = 2.0 * kPiD * i / steps;
        for (const double side : {-0.3, 0.3}) {
            const double r = 1.0 + side * std::cos(0.5 * turn);
            mesh.positions.emplace_back(r * std::cos(turn), side * std::sin(0.5 * turn), r * std::sin(turn));
        }
    }
    for (int i = 0; i < steps; ++i) {
        const auto a = static_cast<unsigned>(2 * i), b = a + 1;
        const bool last = i + 1 == steps;
        const unsigned c = last ? 1 : a + 2, d = last ? 0 : a + 3;
        mesh.triangles.emplace_back(a, b, c);
        mesh.triangles.emplace_back(c, b, d);
    }
    return mesh;
}

/// Several sheets that share one edge, the same triangle twice, needles, a triangle without area.
Mesh tangle()
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0},        {0, 1, 0},        {1, 0, 0},    {0, 0, 1},          {-1, 0, 0},
                      {0.5f, 0.5f, -1}, {-0.9f, 1.5f, 1}, {1, 1.5f, 1}, {1, 1.500001f, -1}, {-1, -1, -1}};
    mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {1, 0, 5}, {0, 1, 2},
                      {6, 7, 8}, {9, 9, 2}, {0, 1, 1}, {2, 9, 5}};
    return mesh;
}

Scene namedScene(const QString& name)
{
    if (name == "sphere") {
        return inRoom([](SceneBuilder& b) {
            b.add("S", sphereMesh({0, 0, 0}, 1, 24), b.addMaterial(sheetMaterial(true)));
        });
    }
    if (name == "torus") {
        return inRoom([](SceneBuilder& b) {
            b.add("T", torusMesh({0, 0, 0}, {0, 1, 0}, 1.0f, 0.3f, 48, 24), b.addMaterial(sheetMaterial(false)));
        });
    }
    if (name == "cylinder") {
        return inRoom([](SceneBuilder& b) {
            b.add("C", cylinderMesh({0, -1, 0}, 0.7f, 1.6f, 40), b.addMaterial(sheetMaterial(false)));
        });
    }
    if (name == "soup") {
        return inRoom([](SceneBuilder& b) { b.add("Soup", soup(600, 3.0f), b.addMaterial(sheetMaterial(true))); });
    }
    if (name == "mobius") {
        return inRoom([](SceneBuilder& b) { b.add("M", mobius(60), b.addMaterial(sheetMaterial(true))); });
    }
    if (name == "tangle") {
        return inRoom([](SceneBuilder& b) { b.add("T", tangle(), b.addMaterial(sheetMaterial(true))); });
    }
    if (name == "tiny" || name == "huge") {
        const float half = name == "tiny" ? 1e-4f : 1e4f;
        return inRoom(
            [&](SceneBuilder& b) {
                b.add("T", torusMesh({0, 0, 0}, {0, 1, 0}, 0.5f * half, 0.15f * half, 24, 12),
                      b.addMaterial(sheetMaterial(false)));
            },
            half);
    }
    return *sampleScene(name.toStdString());
}

/// The scene unwrapped at the usual size, made once for all tests.
const Unwrapped& unwrapped(const QString& name)
{
    static std::map<QString, std::unique_ptr<Unwrapped>> made;
    std::unique_ptr<Unwrapped>& one = made[name];
    if (!one) one = std::make_unique<Unwrapped>(namedScene(name), AtlasOptions{512});
    return *one;
}

/// Names a lookup that reads another chart's texel or none's; "" if there is none.
std::string bleeding(const Unwrapped& u, glm::dvec2 moved = glm::dvec2(0.0))
{
    const Atlas& atlas = *u.atlas;
    FloatImage image(atlas.size, atlas.size);
    for (std::size_t i = 0; i < atlas.owners.size(); ++i) image.pixels[i] = glm::vec3(float(atlas.owners[i]));
    const FloatImage one = halfSize(image), two = halfSize(one);
    const std::vector<glm::dvec3> weights = spreadWeights();
    for (std::size_t f = 0; f < atlas.sides.size(); ++f) {
        const glm::dvec2 centre = uvAt(atlas.uv[f], glm::dvec3(1.0 / 3.0)) * double(atlas.size);
        const auto own = static_cast<double>(
            image.at(std::min(int(centre.x), atlas.size - 1), std::min(int(centre.y), atlas.size - 1)).x);
        for (const glm::dvec3 w : weights) {
            const glm::dvec2 uv = uvAt(atlas.uv[f], w) + moved / double(atlas.size);
            int mip = 0;
            for (const FloatImage* level : {static_cast<const FloatImage*>(&image), &one, &two}) {
                const double read = bilinear(*level, uv).x;
                if (!(std::abs(read - own) <= 1e-5 * (1.0 + own))) {
                    return QString("side %1 at (%2, %3), mip %4: chart %5 instead of %6")
                        .arg(atlas.sides[f])
                        .arg(uv.x * atlas.size)
                        .arg(uv.y * atlas.size)
                        .arg(mip)
                        .arg(read)
                        .arg(own)
                        .toStdString();
                }
                ++mip;
            }
        }
    }
    return {};
}

std::vector<std::array<glm::dvec2, 3>> inTexels(const Atlas& atlas)
{
    std::vector<std::array<glm::dvec2, 3>> triangles;
    for (const auto& uv : atlas.uv) {
        triangles.push_back({glm::dvec2(uv[0]) * double(atlas.size), glm::dvec2(uv[1]) * double(atlas.size),
                             glm::dvec2(uv[2]) * double(atlas.size)});
    }
    return triangles;
}

/// Overlap of triangles in an atlas `size` texels wide.
bool overlaps(const Atlas& atlas, double texels)
{
    std::vector<std::array<glm::dvec2, 3>> unit = inTexels(atlas);
    for (auto& t : unit) {
        for (glm::dvec2& p : t) p /= double(atlas.size);
    }
    return findOverlap(unit, texels / atlas.size, {}).pair.has_value();
}

double twiceArea(const std::array<glm::dvec2, 3>& t)
{
    return (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
}

} // namespace

class AtlasTest : public QObject {
    Q_OBJECT

    static void scenes()
    {
        QTest::addColumn<QString>("name");
        for (const char* name : {"cornell", "two_rooms", "atrium", "gallery", "figure", "sphere", "torus", "cylinder",
                                 "soup", "mobius", "tangle", "tiny", "huge"}) {
            QTest::newRow(name) << name;
        }
    }

private Q_SLOTS:
    void everyFaceHasOnePlace_data() { scenes(); }
    void everyFaceHasOnePlace()
    {
        QFETCH(QString, name);
        const Unwrapped& u = unwrapped(name);
        QVERIFY2(u.atlas, u.error.c_str());
        const Atlas& atlas = *u.atlas;
        QVERIFY(std::ranges::is_sorted(atlas.sides) && std::ranges::adjacent_find(atlas.sides) == atlas.sides.end());
        std::set<std::uint32_t> wanted;
        for (const ReachedFacet& f : u.reach->facets()) {
            const bool isDrawn = f.side % 2 == 0 || u.lit.rays->material(f.side / 2).doubleSided;
            if (isDrawn && u.lit.rays->triangleArea(f.side / 2) > 0.0f) wanted.insert(f.side);
        }
        QVERIFY(!wanted.empty());
        QVERIFY2(std::ranges::equal(atlas.sides, wanted),
                 qPrintable(QString("%1 sides instead of %2").arg(atlas.sides.size()).arg(wanted.size())));

        double flat = 0.0, surface = 0.0;
        const std::vector<std::array<glm::dvec2, 3>> triangles = inTexels(atlas);
        for (std::size_t f = 0; f < triangles.size(); ++f) {
            for (const glm::dvec2 p : triangles[f]) {
                QVERIFY(p.x >= 2.0 - 1e-3 && p.y >= 2.0 - 1e-3); // `>=`: NaN must fail
                QVERIFY(p.x <= atlas.size - 2.0 + 1e-3 && p.y <= atlas.size - 2.0 + 1e-3);
            }
            // counter-clockwise as seen from its side; float corners cost needles their sign
            const SceneTriangle& t = u.lit.rays->triangle(atlas.sides[f] / 2);
            const glm::dvec3 across = glm::cross(glm::dvec3(t.b) - glm::dvec3(t.a), glm::dvec3(t.c) - glm::dvec3(t.a));
            const bool isFront = glm::dot(across, glm::dvec3(u.lit.rays->triangleNormal(atlas.sides[f] / 2))) > 0.0;
            const double turn = isFront == (atlas.sides[f] % 2 == 0) ? 1.0 : -1.0;
            QVERIFY2(turn * twiceArea(triangles[f]) > -1e-3,
                     qPrintable(QString("side %1 is turned over").arg(atlas.sides[f])));
            flat += 0.5 * std::abs(twiceArea(triangles[f]));
            surface += 0.5 * glm::length(across);
        }
        const double density = atlas.report.texelsPerMetre;
        QVERIFY2(std::abs(flat - surface * density * density) <= 1e-3 * flat,
                 qPrintable(QString("%1 texels for %2").arg(flat).arg(surface * density * density)));
    }

    void nothingOverlaps_data() { scenes(); }
    void nothingOverlaps()
    {
        QFETCH(QString, name);
        const Unwrapped& u = unwrapped(name);
        QVERIFY2(u.atlas, u.error.c_str());
        QVERIFY(!overlaps(*u.atlas, 1e-2));
        QCOMPARE(u.atlas->report.overlappingTexels, 0ull);
        std::vector<std::uint8_t> isTaken(u.atlas->texelCount(), 0);
        for (const SurfaceTexel& t : u.atlas->texels) {
            QVERIFY(!isTaken[t.texel]);
            isTaken[t.texel] = 1;
            QVERIFY(u.atlas->owners[t.texel] >= 0);
        }
    }

    void nothingBleedsUpToMipTwo_data() { scenes(); }
    void nothingBleedsUpToMipTwo()
    {
        QFETCH(QString, name);
        const Unwrapped& u = unwrapped(name);
        QVERIFY2(u.atlas, u.error.c_str());
        const std::string found = bleeding(u);
        QVERIFY2(found.empty(), found.c_str());
        QVERIFY2(!bleeding(u, {1.0, 1.0}).empty(), "the check sees nothing of charts that lie a texel off");
        // the black corner
        const glm::dvec2 corner = glm::dvec2(u.atlas->voidUv) * double(u.atlas->size);
        for (int y = int(corner.y) - 4; y < int(corner.y) + 4; ++y) {
            for (int x = int(corner.x) - 4; x < int(corner.x) + 4; ++x) {
                QCOMPARE(u.atlas->owners[std::size_t(y) * std::size_t(u.atlas->size) + std::size_t(x)], -1);
            }
        }
    }

    void texelsStandForTheSurfaceUnderThem_data() { scenes(); }
    void texelsStandForTheSurfaceUnderThem()
    {
        QFETCH(QString, name);
        const Unwrapped& u = unwrapped(name);
        QVERIFY2(u.atlas, u.error.c_str());
        const Atlas& atlas = *u.atlas;
        std::map<std::uint32_t, const SurfaceTexel*> shown;
        for (const SurfaceTexel& t : atlas.texels) shown[t.texel] = &t;
        const double size = 1.0 / atlas.report.texelsPerMetre;
        const double rounding = 1e-5 * double(u.lit.scene->bounds.diagonal());
        const std::vector<glm::dvec3> weights = spreadWeights();
        for (std::size_t f = 0; f < atlas.sides.size(); ++f) {
            const SceneTriangle& t = u.lit.rays->triangle(atlas.sides[f] / 2);
            for (const glm::dvec3 w : weights) {
                const glm::dvec2 p = uvAt(atlas.uv[f], w) * double(atlas.size);
                const auto texel = static_cast<std::uint32_t>(int(p.y) * atlas.size + int(p.x));
                const auto found = shown.find(texel); // a grazed texel too
                QVERIFY2(found != shown.end(), qPrintable(QString("nothing at (%1, %2)").arg(p.x).arg(p.y)));
                // half a diagonal from the centre on both sides, and a notch of the chart's border may lie between
                const double apart = glm::length(positionAt(t, w) - glm::dvec3(found->second->position));
                QVERIFY2(apart <= 2.0 * size / double(atlas.report.stretch.leastScale) + rounding,
                         qPrintable(QString("%1 m apart, texels of %2 m").arg(apart).arg(size)));
                QVERIFY(std::abs(glm::length(found->second->normal) - 1.0f) <= 1e-5f);
            }
        }
    }

    void texelCentresAreInterpolated()
    {
        const Unwrapped u(*sampleScene("cornell"), {256});
        QVERIFY2(u.atlas, u.error.c_str());
        std::map<std::uint32_t, const SurfaceTexel*> shown;
        for (const SurfaceTexel& t : u.atlas->texels) shown[t.texel] = &t;
        int checked = 0;
        for (std::size_t f = 0; f < u.atlas->sides.size(); ++f) {
            const std::array<glm::dvec2, 3> t = inTexels(*u.atlas)[f];
            for (const auto& [texel, surface] : shown) {
                const glm::dvec2 p(texel % 256 + 0.5, texel / 256 + 0.5);
                const glm::dvec3 w =
                    glm::dvec3(twiceArea({p, t[1], t[2]}), twiceArea({t[0], p, t[2]}), twiceArea({t[0], t[1], p})) /
                    twiceArea(t);
                if (!(std::min(w.x, std::min(w.y, w.z)) > 1e-6)) continue;
                const glm::dvec3 expected = positionAt(u.lit.rays->triangle(u.atlas->sides[f] / 2), w);
                const double apart = glm::length(expected - glm::dvec3(surface->position));
                QVERIFY2(apart <= 1e-5, qPrintable(QString("%1 m apart").arg(apart)));
                ++checked;
            }
        }
        QVERIFY2(checked > 20'000, qPrintable(QString::number(checked)));
    }

    void sameOnAnyNumberOfThreads()
    {
        const Unwrapped one(*figureScene(6000), {512}, 1), five(*figureScene(6000), {512}, 5);
        QVERIFY(one.atlas && five.atlas);
        QVERIFY(one.atlas->sides == five.atlas->sides && one.atlas->uv == five.atlas->uv);
        QVERIFY(one.atlas->owners == five.atlas->owners);
        QCOMPARE(one.atlas->texels.size(), five.atlas->texels.size());
        for (std::size_t i = 0; i < one.atlas->texels.size(); ++i) {
            const SurfaceTexel &a = one.atlas->texels[i], &b = five.atlas->texels[i];
            QVERIFY(a.texel == b.texel && a.position == b.position && a.normal == b.normal);
        }
    }

    void aBoxHasSixChartsTrueToScale()
    {
        const Unwrapped u(inRoom([](SceneBuilder& b) {
            b.add("Box", boxMesh({-0.5f, -0.4f, -0.3f}, {0.5f, 0.4f, 0.3f}), b.addMaterial(sheetMaterial(false)));
        }));
        QVERIFY2(u.atlas, u.error.c_str());
        QCOMPARE(u.atlas->report.charts, 12ull); // and six of the room
        QVERIFY(std::abs(u.atlas->report.stretch.meanAnisotropy() - 1.0) <= 1e-9);
        QVERIFY(u.atlas->report.utilisation > 0.5 && u.atlas->report.utilisation < 1.0);
    }

    void bothSidesOfASheetHaveTheirOwn()
    {
        for (const bool doubleSided : {false, true}) {
            const Unwrapped u(inRoom([&](SceneBuilder& b) {
                b.add("Sheet", quadMesh({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}), b.addMaterial(sheetMaterial(doubleSided)));
            }));
            QVERIFY2(u.atlas, u.error.c_str());
            int fronts = 0, backs = 0;
            for (const std::uint32_t side : u.atlas->sides) {
                if (u.nodeOf(side) == "Sheet") ++(side % 2 ? backs : fronts);
            }
            QCOMPARE(fronts, 2);
            QCOMPARE(backs, doubleSided ? 2 : 0);
            int up = 0, down = 0;
            for (const SurfaceTexel& t : u.atlas->texels) {
                if (std::abs(t.position.y) > 1e-4f) continue; // walls' texels at this height face sideways
                up += t.normal.y > 0.99f, down += t.normal.y < -0.99f;
            }
            QVERIFY(up > 1000);
            QVERIFY(doubleSided ? down > 1000 : down == 0);
        }
    }

    void hiddenFacesHaveNoPlace() // the outside of a room of double-sided walls, the inside of a box
    {
        SceneBuilder builder("closed");
        const int sheet = builder.addMaterial(sheetMaterial(true));
        builder.add("Room", boxMesh(glm::vec3(-2), glm::vec3(2), Facing::in), sheet);
        builder.add("Box", boxMesh(glm::vec3(-0.5f), glm::vec3(0.5f)), sheet);
        builder.addPoint("Lamp", glm::vec3(1.5f), glm::vec3(100.0f));
        const Unwrapped u(builder.finish());
        QVERIFY2(u.atlas, u.error.c_str());
        QCOMPARE(u.atlas->sides.size(), std::size_t(24));
        for (const std::uint32_t side : u.atlas->sides) QCOMPARE(side % 2, 0u);
        QCOMPARE(u.atlas->report.unlitFaces, 24ull);
        QVERIFY(!u.atlas->find(u.atlas->sides.front() + 1) && u.atlas->find(u.atlas->sides.front()));
    }

    void instancesHavePlacesOfTheirOwn() // one of them mirrored
    {
        const Unwrapped u(inRoom([](SceneBuilder& b) {
            const int mesh = b.addMesh(sphereMesh({0, 0, 0}, 0.4f, 8), b.addMaterial(sheetMaterial(false)));
            glm::mat4 left(1.0f), right(1.0f);
            left[3] = glm::vec4(-1, 0, 0, 1);
            right[0] = glm::vec4(-1, 0, 0, 0), right[3] = glm::vec4(1, 0, 0, 1);
            b.place("Left", mesh, left);
            b.place("Right", mesh, right);
        }));
        QVERIFY2(u.atlas, u.error.c_str());
        std::map<std::string, int> places;
        for (const std::uint32_t side : u.atlas->sides) ++places[u.nodeOf(side)];
        QVERIFY(places["Left"] > 0);
        QCOMPARE(places["Left"], places["Right"]);
        int seen = 0;
        for (const SurfaceTexel& t : u.atlas->texels) { // normals point out of the balls
            const glm::vec3 centre(t.position.x < 0.0f ? -1.0f : 1.0f, 0.0f, 0.0f);
            const glm::vec3 out = t.position - centre;
            if (glm::length(out) > 0.41f) continue;
            QVERIFY(glm::dot(glm::normalize(out), t.normal) > 0.9f);
            ++seen;
        }
        QVERIFY(seen > 1000);
    }

    void sizesFollowDensity()
    {
        const Unwrapped some(*sampleScene("cornell"), {1024, 100.0}), twice(*sampleScene("cornell"), {1024, 200.0});
        QVERIFY(some.atlas && twice.atlas);
        QCOMPARE(some.atlas->report.texelsPerMetre, 100.0);
        QCOMPARE(twice.atlas->size, 2 * some.atlas->size);
        QCOMPARE(some.atlas->size, 256);
    }

    void refusals()
    {
        QVERIFY(Unwrapped(*sampleScene("cornell"), {1024, 1e6}).error.find("texels per metre") != std::string::npos);
        QVERIFY(Unwrapped(namedScene("soup"), {64}).error.find("do not fit into an atlas of 64") != std::string::npos);
        QVERIFY(Unwrapped(*sampleScene("cornell"), {1023}).error.find("in steps of 4") != std::string::npos);
        QVERIFY(Unwrapped(*sampleScene("cornell"), {8192}).error.find("8192") != std::string::npos);
        QVERIFY(!Unwrapped(*sampleScene("cornell"), {1024, -1.0}).error.empty());
        QVERIFY(!Unwrapped(*sampleScene("cornell"), {1024, std::nan("")}).error.empty());
    }

    void nothingToUnwrap()
    {
        SceneBuilder empty("empty");
        const Unwrapped none(empty.finish());
        QVERIFY2(none.atlas, none.error.c_str());
        QVERIFY(none.atlas->sides.empty() && none.atlas->texels.empty());
        QCOMPARE(none.atlas->size, 1024);
        QCOMPARE(none.atlas->report.utilisation, 0.0);
        QVERIFY(Unwrapped(SceneBuilder("empty").finish(), {1024, 10.0}).atlas);
    }

    void stopsWhenAsked()
    {
        const LitScene lit(*figureScene(20'000));
        Workers workers(2);
        const auto reach = LightReach::find(*lit.rays, *lit.lights, workers, {});
        std::stop_source before;
        before.request_stop();
        const auto none = makeAtlas(*lit.rays, *reach, {}, workers, before.get_token());
        QVERIFY(!none && none.error().kind == Error::Kind::cancelled);
        std::stop_source during;
        double last = 0.0;
        std::mutex mutex;
        const auto some = makeAtlas(*lit.rays, *reach, {}, workers, during.get_token(), [&](double f) {
            std::lock_guard lock(mutex);
            last = std::max(last, f);
            during.request_stop();
        });
        QVERIFY(!some && some.error().kind == Error::Kind::cancelled);
        QVERIFY2(last > 0.0 && last < 0.9, qPrintable(QString::number(last)));
    }

    void sceneUvIsTakenIfItIsFit()
    {
        const auto quads = [](glm::vec2 first, glm::vec2 second, float size) {
            return inRoomOfQuads({first, second}, size);
        };
        AtlasOptions options{256, 0.0, true};
        const Unwrapped fit(quads({0.0f, 0.0f}, {0.5f, 0.5f}, 0.5f), options);
        QVERIFY2(fit.atlas, fit.error.c_str());
        QCOMPARE(fit.atlas->sides.size(), std::size_t(4));
        QVERIFY(std::abs(fit.atlas->report.utilisation - 0.5) <= 0.01);
        QVERIFY(!overlaps(*fit.atlas, 1e-2));
        QVERIFY(Unwrapped(quads({0.0f, 0.0f}, {0.4f, 0.4f}, 0.5f), options).error.find("overlaps: B lies on A") !=
                std::string::npos);
        QVERIFY(Unwrapped(quads({0.0f, 0.0f}, {0.6f, 0.6f}, 0.5f), options).error.find("leaves 0..1") !=
                std::string::npos);
        QVERIFY(Unwrapped(*sampleScene("cornell"), options).error.find("no second UV set") != std::string::npos);
        // two instances of one mesh lie on each other
        SceneBuilder builder("instances");
        Mesh quad = texturedQuadMesh({-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
        quad.uv[1] = quad.uv[0];
        const int mesh = builder.addMesh(quad, builder.addMaterial("grey", glm::vec3(0.5f)));
        builder.place("A", mesh, glm::mat4(1.0f));
        glm::mat4 up(1.0f);
        up[3].y = -1.0f;
        builder.place("B", mesh, up);
        builder.addPoint("Lamp", {0, 1, 0}, glm::vec3(10.0f));
        builder.addPoint("Under", {0, -0.5f, 0}, glm::vec3(10.0f));
        QVERIFY(Unwrapped(builder.finish(), options).error.find("overlaps") != std::string::npos);
    }

    void aBentSheetUnrollsExactly() // developable: least squares find the isometry
    {
        SurfaceMesh sheet;
        constexpr int kSteps = 32;
        for (int i = 0; i <= kSteps; ++i) {
            for (int j = 0; j <= kSteps; ++j) {
                const double turn = 0.5 * kPiD * i / kSteps;
                sheet.positions.emplace_back(std::cos(turn), double(j) / kSteps, std::sin(turn));
            }
        }
        for (unsigned i = 0; i < kSteps; ++i) {
            for (unsigned j = 0; j < kSteps; ++j) {
                const unsigned a = i * (kSteps + 1) + j, b = a + kSteps + 1;
                sheet.triangles.emplace_back(a, a + 1, b);
                sheet.triangles.emplace_back(b, a + 1, b + 1);
            }
        }
        QVERIFY(borderOf(sheet).isDisc(sheet));
        const auto map = conformalMap(sheet);
        QVERIFY(map.has_value());
        QVERIFY(isSimple(borderOf(sheet), *map));
        const double scale = 1.0 / glm::length((*map)[1] - (*map)[0]) / kSteps; // of an edge of length 1 / kSteps
        double worst = 0.0;
        for (const glm::uvec3 t : sheet.triangles) {
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t a = t[k], b = t[(k + 1) % 3];
                const double real = glm::length(sheet.positions[b] - sheet.positions[a]);
                worst = std::max(worst, std::abs(scale * glm::length((*map)[b] - (*map)[a]) / real - 1.0));
            }
        }
        QVERIFY2(worst <= 1e-6, qPrintable(QString::number(worst)));
    }

    void overlapsAreFound()
    {
        using T = std::array<glm::dvec2, 3>;
        const T a{glm::dvec2(0.1, 0.1), glm::dvec2(0.5, 0.1), glm::dvec2(0.1, 0.5)};
        const T beside{glm::dvec2(0.5, 0.1), glm::dvec2(0.5, 0.5), glm::dvec2(0.1, 0.5)}; // shares an edge
        const T on{glm::dvec2(0.4, 0.05), glm::dvec2(0.45, 0.3), glm::dvec2(0.9, 0.2)};
        QVERIFY(!findOverlap({a, beside}, 1e-6, {}).pair);
        const auto found = findOverlap({a, beside, on}, 1e-6, {}).pair;
        QVERIFY(found && found->first < 2 && found->second == 2);
        QVERIFY(findOverlap({a, T{a[0], a[2], a[1]}}, 1e-6, {}).pair); // the same, turned over
        const T rises{glm::dvec2(0.0, 0.0), glm::dvec2(0.0, 0.02), glm::dvec2(1.0, 0.5)};
        const T level{glm::dvec2(0.1, 0.42), glm::dvec2(0.1, 0.4), glm::dvec2(1.0, 0.4)};
        const T between{glm::dvec2(0.05, 0.2), glm::dvec2(0.05, 0.3), glm::dvec2(0.2, 0.25)}; // ends before they meet
        QVERIFY(!findOverlap({rises, between}, 1e-6, {}).pair && !findOverlap({between, level}, 1e-6, {}).pair);
        const auto met = findOverlap({rises, between, level}, 1e-6, {}).pair;
        QVERIFY(met && met->first == 0 && met->second == 2);
    }

    void overlapsAreThoseOfAllPairs() // a mesh with its corners moved by chance, some further than to the next
    {
        const auto reach = [](const std::array<glm::dvec2, 3>& t, const std::array<glm::dvec2, 3>& u) {
            const std::vector<std::array<glm::dvec2, 3>> two{t, u};
            return findOverlap(two, 1e-9, {}).pair.has_value();
        };
        Rng rng(1, hashName("overlaps"), 0);
        int with = 0, without = 0;
        for (int round = 0; round < 300; ++round) {
            const double shake = round % 3 == 0 ? 0.4 : round % 3 == 1 ? 0.9 : 1.3; // of the corners' distance
            const double squeeze = round % 2 == 0 ? 1.0 : 0.01;                     // slivers
            constexpr int kSide = 6;
            std::array<glm::dvec2, (kSide + 1) * (kSide + 1)> corners;
            for (int i = 0; i <= kSide; ++i) {
                for (int j = 0; j <= kSide; ++j) {
                    const glm::dvec2 moved(rng.uniformDouble() - 0.5, rng.uniformDouble() - 0.5);
                    const glm::dvec2 p = (glm::dvec2(i, j) + shake * moved) * glm::dvec2(1.0, squeeze);
                    corners[static_cast<std::size_t>(i * (kSide + 1) + j)] = {p.x + p.y, p.y - p.x}; // aslant
                }
            }
            std::vector<std::array<glm::dvec2, 3>> all;
            for (int i = 0; i < kSide; ++i) {
                for (int j = 0; j < kSide; ++j) {
                    const auto at = [&](int x, int y) {
                        return corners[static_cast<std::size_t>(x * (kSide + 1) + y)];
                    };
                    all.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
                    all.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
                }
            }
            bool doAny = false;
            for (std::size_t i = 0; i < all.size(); ++i) {
                for (std::size_t j = 0; j < i; ++j) doAny = doAny || reach(all[i], all[j]);
            }
            const auto found = findOverlap(all, 1e-9, {}).pair;
            QVERIFY2(found.has_value() == doAny, qPrintable(QString("round %1").arg(round)));
            if (found) QVERIFY(found->first < found->second && reach(all[found->first], all[found->second]));
            (doAny ? with : without) += 1;
        }
        QVERIFY2(with > 60 && without > 60, qPrintable(QString("%1 %2").arg(with).arg(without)));
    }

    void sliversCostAsMuchAsOthers_data()
    {
        QTest::addColumn<bool>("isFan");
        QTest::newRow("strips across the square") << false;
        QTest::newRow("a fan from a corner") << true;
    }
    void sliversCostAsMuchAsOthers()
    {
        QFETCH(bool, isFan);
        const auto slivers = [&](int count) { // corner to corner, or around one
            std::vector<std::array<glm::dvec2, 3>> all;
            for (int i = 0; i < count; ++i) {
                const double a = double(i) / count, b = double(i + 1) / count;
                if (isFan) {
                    all.push_back({glm::dvec2(0.0), glm::dvec2(1.0 - a, a), glm::dvec2(1.0 - b, b)});
                } else {
                    all.push_back({glm::dvec2(0.0, a), glm::dvec2(0.0, b), glm::dvec2(1.0, a)});
                    all.push_back({glm::dvec2(0.0, b), glm::dvec2(1.0, b), glm::dvec2(1.0, a)});
                    for (std::size_t k = all.size() - 2; k < all.size(); ++k) {
                        for (glm::dvec2& p : all[k]) p = {0.5 * (p.x + p.y), 0.5 * (p.y - p.x + 1.0)};
                    }
                }
            }
            return all;
        };
        for (const int count : {1000, 30'000}) {
            std::vector<std::array<glm::dvec2, 3>> all = slivers(count);
            const OverlapSearch none = findOverlap(all, 1e-9, {});
            const double n = double(all.size());
            qInfo("%d: %.1f comparisons a triangle", int(all.size()), double(none.comparisons) / n);
            QVERIFY(!none.pair);
            QVERIFY2(double(none.comparisons) <= n * (2.0 * std::log2(n) + 8.0),
                     qPrintable(QString("%1 for %2").arg(none.comparisons).arg(n)));
            all.push_back({glm::dvec2(0.4, 0.4), glm::dvec2(0.4001, 0.4), glm::dvec2(0.4, 0.4001)});
            QVERIFY(findOverlap(all, 1e-9, {}).pair);
        }
    }

private:
    /// Two quads that face a lamp, their second UV sets squares of `size` at the two corners.
    static Scene inRoomOfQuads(const std::array<glm::vec2, 2>& corners, float size)
    {
        SceneBuilder builder("quads");
        const int grey = builder.addMaterial("grey", glm::vec3(0.5f));
        for (std::size_t i = 0; i < 2; ++i) {
            Mesh quad = texturedQuadMesh({-1.0f + 3.0f * float(i), 0, -1}, {0, 0, 2}, {2, 0, 0});
            for (const glm::vec2 p : quad.uv[0]) quad.uv[1].push_back(corners[i] + size * p);
            builder.add(i == 0 ? "A" : "B", quad, grey);
        }
        builder.addPoint("Lamp", {0.5f, 2, 0}, glm::vec3(10.0f));
        return builder.finish();
    }
};

QTEST_APPLESS_MAIN(AtlasTest)
#include "tst_atlas.moc"
